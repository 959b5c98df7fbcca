//! Diffeomorphisms: smooth, invertible maps of space, in closed form.

mod chain;
mod local_translation;
mod straightening;

use nalgebra::{SMatrix, SVector};

use crate::real::Real;

pub use chain::Chain;
pub use local_translation::LocalTranslation;
pub use straightening::Straightening;

/// A smooth map `y = psi(x)` of space onto itself with a smooth inverse.
///
/// Its inverse may map a straight line to a path around a corner. The potential `|psi(x) - psi(p*)|` is zero only at
/// the goal.
///
/// # Guarantees
/// - `psi` is smooth, and one-to-one from the whole space onto the whole space.
/// - `det J > 0` everywhere, and above a positive number that each implementation states.
/// - No panic for any input. For finite input, `apply` and `inverse` never return NaN; a result too large for `T` is
///   infinite. A Jacobian with an entry too large for `T` is not finite.
pub trait Diffeomorphism<T: Real, const D: usize> {
    /// The image `psi(x)` of `position` (metres).
    fn apply(&self, position: &SVector<T, D>) -> SVector<T, D>;

    /// The position `psi^-1(y)` whose image is `image` (metres).
    fn inverse(&self, image: &SVector<T, D>) -> SVector<T, D>;

    /// [`apply`](Self::apply) and [`jacobian`](Self::jacobian) together, at the cost of one.
    fn apply_with_jacobian(&self, position: &SVector<T, D>) -> (SVector<T, D>, SMatrix<T, D, D>);

    /// The Jacobian `J = d psi / d x` at `position`: row `i`, column `j` is `d y_i / d x_j` (no unit).
    fn jacobian(&self, position: &SVector<T, D>) -> SMatrix<T, D, D> {
        self.apply_with_jacobian(position).1
    }
}
