//! A translation of the neighbourhood of one point.

use nalgebra::{SMatrix, SVector};
use serde::{Deserialize, Serialize};

use super::Diffeomorphism;
use crate::{
    error::{DynamicsError, ensure_finite, ensure_positive},
    real::Real,
};

/// Newton steps of the inverse before it switches to bisection; about six are usual.
const NEWTON_STEPS: usize = 24;

/// Bisections that take a bracket from 1 down to the rounding of an `f64`.
const BISECTIONS: usize = 53;

/// A translation by `v` at the centre `c`, which fades out within a few times `1 / rho`.
///
/// ```text
/// psi(x) = x + k(x) v,     k(x) = exp(-rho^2 |x - c|^2)
/// J(x) = I - 2 rho^2 k(x) v (x - c)^T,     det J = 1 - 2 rho^2 k(x) v^T (x - c)
/// ```
///
/// # Invertibility
/// `psi - id` is Lipschitz with the constant `q = sqrt(2/e) rho |v|`, the [`contraction`](Self::contraction): the
/// gradient of `k` is longest at `|x - c| = 1 / (sqrt(2) rho)`, where it is `sqrt(2/e) rho`. For `q < 1`
///
/// ```text
/// (1 - q) |a - b| <= |psi(a) - psi(b)| <= (1 + q) |a - b|
/// ```
///
/// so `psi` is one-to-one and onto, the singular values of `J` lie within `[1 - q, 1 + q]`, and `det J >= 1 - q`, which
/// is attained at `x = c + v / (sqrt(2) rho |v|)`. Here `q` is at most [`MAX_CONTRACTION`](Self::MAX_CONTRACTION).
///
/// # Numerics
/// The error of the inverse, measured in the image, is a few `epsilon` times the largest of `|y|`, `|c|` and `|v|`.
/// Jacobians are finite for every finite position. Where `k` underflows, `psi` is exactly the identity.
///
/// # References
/// N. Perrin, P. Schlehuber-Caissier, "Fast diffeomorphic matching to learn globally asymptotically stable nonlinear
/// dynamical systems", Systems & Control Letters 96 (2016).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(
    try_from = "UncheckedTranslation<T, D>",
    bound(serialize = "T: Real + Serialize", deserialize = "T: Real + Deserialize<'de>")
)]
pub struct LocalTranslation<T, const D: usize> {
    centre: SVector<T, D>,
    rate: T,
    translation: SVector<T, D>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields, bound(deserialize = "T: Real + Deserialize<'de>"))]
struct UncheckedTranslation<T, const D: usize> {
    centre: SVector<T, D>,
    rate: T,
    translation: SVector<T, D>,
}

impl<T: Real, const D: usize> TryFrom<UncheckedTranslation<T, D>> for LocalTranslation<T, D> {
    type Error = DynamicsError;

    fn try_from(unchecked: UncheckedTranslation<T, D>) -> Result<Self, DynamicsError> {
        Self::new(unchecked.centre, unchecked.rate, unchecked.translation)
    }
}

impl<T: Real, const D: usize> LocalTranslation<T, D> {
    /// The largest [`contraction`](Self::contraction) accepted: `det J` is at least 1 minus it.
    pub const MAX_CONTRACTION: f64 = 0.95;

    /// The translation by `translation` (metres) at `centre` (metres), fading with the rate `rate` (1/m).
    ///
    /// # Errors
    /// - [`DynamicsError::NonFinite`]: a component of the centre or the translation.
    /// - [`DynamicsError::NotPositive`]: the rate is not positive and finite.
    /// - [`DynamicsError::NotInvertible`]: the contraction is above [`MAX_CONTRACTION`](Self::MAX_CONTRACTION).
    pub fn new(centre: SVector<T, D>, rate: T, translation: SVector<T, D>) -> Result<Self, DynamicsError> {
        ensure_finite("centre", &centre)?;
        ensure_finite("translation", &translation)?;
        ensure_positive("the rate of a Gaussian bump", " per metre", rate)?;
        let checked = Self {
            centre,
            rate,
            translation,
        };
        let contraction = checked.contraction();
        // Written so that an overflowed (NaN or infinite) contraction is refused as well.
        if contraction <= T::rounded(Self::MAX_CONTRACTION) {
            Ok(checked)
        } else {
            Err(DynamicsError::NotInvertible {
                contraction: contraction.as_f64(),
                largest: Self::MAX_CONTRACTION,
            })
        }
    }

    /// The centre `c` (metres).
    pub fn centre(&self) -> &SVector<T, D> {
        &self.centre
    }

    /// The rate `rho` (1/m).
    pub fn rate(&self) -> T {
        self.rate
    }

    /// The translation `v` at the centre (metres).
    pub fn translation(&self) -> &SVector<T, D> {
        &self.translation
    }

    /// `q = sqrt(2/e) rho |v|`, from 0 to [`MAX_CONTRACTION`](Self::MAX_CONTRACTION) (no unit).
    pub fn contraction(&self) -> T {
        self.scaled_translation().norm() * T::rounded((2.0 / std::f64::consts::E).sqrt())
    }

    /// `1 - q`, the least value of `det J` (no unit).
    pub fn determinant_lower_bound(&self) -> T {
        T::one() - self.contraction()
    }

    /// `w = rho v` (no unit); its length is at most `0.95 sqrt(e / 2)`, about 1.11.
    fn scaled_translation(&self) -> SVector<T, D> {
        self.translation * self.rate
    }

    /// `z = rho (x - c)`, so that the bump is `exp(-|z|^2)` (no unit). Components may be infinite, but never NaN.
    fn scaled_offset(&self, position: &SVector<T, D>) -> SVector<T, D> {
        SVector::from_fn(|i, _| {
            let offset = position[i] - self.centre[i];
            if offset.is_finite() {
                return offset * self.rate;
            }
            // The difference of two finite numbers can overflow, but half of it cannot.
            let half = T::rounded(0.5);
            let scaled = (position[i] * half - self.centre[i] * half) * self.rate;
            scaled + scaled
        })
    }

    fn jacobian_at(&self, scaled_offset: &SVector<T, D>, height: T) -> SMatrix<T, D, D> {
        if height.is_zero() {
            // The offset may be infinite, and 0 times infinity is NaN.
            return SMatrix::identity();
        }
        let gradient = scaled_offset * (height + height);
        SMatrix::identity() - self.scaled_translation() * gradient.transpose()
    }
}

impl<T: Real, const D: usize> Diffeomorphism<T, D> for LocalTranslation<T, D> {
    fn apply(&self, position: &SVector<T, D>) -> SVector<T, D> {
        position + self.translation * bump_height(&self.scaled_offset(position))
    }

    fn inverse(&self, image: &SVector<T, D>) -> SVector<T, D> {
        let share = share(&self.scaled_offset(image), &self.scaled_translation(), NEWTON_STEPS);
        image - self.translation * share
    }

    fn apply_with_jacobian(&self, position: &SVector<T, D>) -> (SVector<T, D>, SMatrix<T, D, D>) {
        let scaled_offset = self.scaled_offset(position);
        let height = bump_height(&scaled_offset);
        (
            position + self.translation * height,
            self.jacobian_at(&scaled_offset, height),
        )
    }
}

/// `exp(-|z|^2)`, between 0 and 1. Where it is not 0, all components of `z` are small.
fn bump_height<T: Real, const D: usize>(scaled_offset: &SVector<T, D>) -> T {
    (-scaled_offset.norm_squared()).exp()
}

/// The root `s` in `[0, 1]` of `h(s) = s - exp(-|z - s w|^2)`, with `z = rho (y - c)`, `w = rho v`.
fn share<T: Real, const D: usize>(z: &SVector<T, D>, w: &SVector<T, D>, newton_steps: usize) -> T {
    let half = T::rounded(0.5);
    let (mut low, mut high) = (T::zero(), T::one());
    // The first step of a fixed-point iteration; far from the centre it is sufficient.
    let mut s = bump_height(z);
    if s.is_zero() {
        return s;
    }
    for step in 0..newton_steps + BISECTIONS {
        let offset = z - w * s;
        let height = bump_height(&offset);
        let h = s - height;
        if h > T::zero() {
            high = s;
        } else {
            low = s;
        }
        let slope = T::one() - (height + height) * offset.dot(w);
        let newton = s - h / slope;
        let inside = low <= newton && newton <= high;
        // The error in the image is h v. Once h is below its own rounding error, one last step is enough.
        if h.abs() <= T::rounded(4.0) * T::EPSILON || high - low <= T::EPSILON {
            return if inside { newton } else { s };
        }
        s = if inside && step < newton_steps {
            newton
        } else {
            (low + high) * half
        };
    }
    s
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector2;

    use super::*;

    #[test]
    fn newton_and_bisection_find_the_same_root() {
        // The hardest case: as steep as allowed, all around the singular point.
        let length = 0.95 / (2.0 / std::f64::consts::E).sqrt();
        let w = Vector2::new(length, 0.0);
        for i in -300..=300 {
            for height in [0.0, 0.3, 1.5] {
                let z = Vector2::new(f64::from(i) * 0.01, height);
                let (newton, bisection) = (share(&z, &w, NEWTON_STEPS), share(&z, &w, 0));
                assert!((newton - bisection).abs() < 1e-13, "{z}");
                assert!((newton - bump_height(&(z - w * newton))).abs() < 1e-15);
            }
        }
    }

    #[test]
    fn an_offset_that_overflows_still_has_an_effect() {
        // rho (x - c) = 5e-309 * 2 * 1.797...e308, although x - c alone is infinite.
        let (far, rate) = (f64::MAX, 5e-309);
        let map = LocalTranslation::new(Vector2::new(-far, 0.0), rate, Vector2::new(-1e308, 0.0)).unwrap();
        let image = map.apply(&Vector2::new(far, 0.0));
        let k = (-(2.0 * (far * rate)).powi(2)).exp();
        assert!(k > 0.03);
        assert!((image.x - (far - 1e308 * k)).abs() <= 1e-14 * far);
        assert!((map.inverse(&image).x - far).abs() <= 1e-14 * far);
    }

    #[test]
    fn a_translation_by_hand() {
        // rho = 1/2, x - c = (2, 0): k = 1/e; J = I - 2/4 k v (2, 0) = [1 - k/2, 0; -k, 1].
        let map = LocalTranslation::new(Vector2::new(1.0, 1.0), 0.5, Vector2::new(0.5, 1.0)).unwrap();
        let k = (-1.0_f64).exp();
        let (image, jacobian) = map.apply_with_jacobian(&Vector2::new(3.0, 1.0));
        assert!((image - Vector2::new(3.0 + 0.5 * k, 1.0 + k)).norm() < 1e-15);
        let expected = nalgebra::Matrix2::new(1.0 - 0.5 * k, 0.0, -k, 1.0);
        assert!((jacobian - expected).norm() < 1e-15);
    }
}
