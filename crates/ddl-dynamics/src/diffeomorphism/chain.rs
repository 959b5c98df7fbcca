//! Composition of diffeomorphisms.

use nalgebra::{SMatrix, SVector};
use serde::{Deserialize, Serialize};

use super::{Diffeomorphism, LocalTranslation};
use crate::real::Real;

/// The composition `psi = psi_n o ... o psi_2 o psi_1` of local translations; the identity if empty.
///
/// ```text
/// psi^-1 = psi_1^-1 o ... o psi_n^-1,     J = J_n ... J_2 J_1
/// ```
///
/// with `J_i` taken at the image under the layers before it. Deserialising a chain checks every layer as its
/// constructor does. The errors of the layers add up, each magnified by the stretch of the layers after it.
///
/// # Examples
/// ```
/// use ddl_dynamics::{Chain, Diffeomorphism, LocalTranslation};
/// use nalgebra::Vector2;
///
/// let push = LocalTranslation::new(Vector2::new(0.0, 1.0), 0.5, Vector2::new(1.0, 0.0))?;
/// let lift = LocalTranslation::new(Vector2::zeros(), 1.0, Vector2::new(0.0, 0.5))?;
/// let x = Vector2::new(0.3, -0.2);
/// assert_eq!(Chain::new(vec![push, lift]).apply(&x), lift.apply(&push.apply(&x)));
/// # Ok::<(), ddl_dynamics::DynamicsError>(())
/// ```
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(
    deny_unknown_fields,
    bound(serialize = "T: Real + Serialize", deserialize = "T: Real + Deserialize<'de>")
)]
pub struct Chain<T, const D: usize> {
    layers: Vec<LocalTranslation<T, D>>,
}

impl<T: Real, const D: usize> Chain<T, D> {
    /// The chain of `layers`, the first of which is applied first.
    pub fn new(layers: Vec<LocalTranslation<T, D>>) -> Self {
        Self { layers }
    }

    /// The layers, the first of which is applied first.
    pub fn layers(&self) -> &[LocalTranslation<T, D>] {
        &self.layers
    }

    /// The natural logarithm of a lower bound of `det J` (no unit). The bound itself may be too small for `T`.
    pub fn log_determinant_lower_bound(&self) -> T {
        self.layers
            .iter()
            .fold(T::zero(), |sum, layer| sum + layer.determinant_lower_bound().ln())
    }
}

impl<T: Real, const D: usize> Diffeomorphism<T, D> for Chain<T, D> {
    fn apply(&self, position: &SVector<T, D>) -> SVector<T, D> {
        let layers = self.layers.iter();
        layers.fold(*position, |point, layer| layer.apply(&point))
    }

    fn inverse(&self, image: &SVector<T, D>) -> SVector<T, D> {
        let layers = self.layers.iter().rev();
        layers.fold(*image, |point, layer| layer.inverse(&point))
    }

    fn apply_with_jacobian(&self, position: &SVector<T, D>) -> (SVector<T, D>, SMatrix<T, D, D>) {
        let start = (*position, SMatrix::identity());
        self.layers.iter().fold(start, |(point, jacobian), layer| {
            let (image, factor) = layer.apply_with_jacobian(&point);
            (image, factor * jacobian)
        })
    }
}
