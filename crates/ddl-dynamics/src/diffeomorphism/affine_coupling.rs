//! One coordinate scaled and shifted by amounts that depend on the others.

use nalgebra::{SMatrix, SVector};
use serde::{Deserialize, Serialize};

use super::{Diffeomorphism, components, gaussian};
use crate::{
    error::{DynamicsError, ensure_finite},
    real::Real,
};

/// A Gaussian bump `k(x) = exp(-rho^2 |x_rest - c_rest|^2)` over the coordinates that an
/// [`AffineCoupling`] does not move, and what it adds there.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(
    deny_unknown_fields,
    bound(
        serialize = "T: Real + Serialize",
        deserialize = "T: Real + Deserialize<'de>"
    )
)]
pub struct CouplingBump<T, const D: usize> {
    /// The centre `c` (metres). Its component along the moved coordinate must be finite and is not
    /// looked at.
    #[serde(with = "components")]
    pub centre: SVector<T, D>,
    /// The rate `rho` with which the bump fades (1/m).
    pub rate: T,
    /// The weight `a` of the bump in the logarithm of the scale (no unit).
    pub log_scale: T,
    /// The weight `b` of the bump in the shift (metres).
    pub shift: T,
}

/// A map that moves one coordinate `j` and leaves the others (`rest`) as they are.
///
/// ```text
/// y_j = x_j exp(s(x_rest)) + t(x_rest),     y_rest = x_rest
/// s = B tanh(a_1 k_1 + a_2 k_2 + ...),      t = b_1 k_1 + b_2 k_2 + ...
/// J_jj = exp(s),     J_jl = x_j exp(s) ds/dx_l + dt/dx_l,     J_il = [i = l] otherwise
/// ```
///
/// with the Gaussian bumps `k_i` of [`CouplingBump`]. The determinant is `exp(s)`, so it is within
/// `[exp(-B), exp(B)]`; `B` is the largest log scale. The inverse is `x_j = (y_j - t) exp(-s)`, with
/// no iteration. Layers that move different coordinates in turn, in a [`Chain`](super::Chain), can
/// move every point.
///
/// In one dimension there is no rest: every bump is 1, and the map is `y = x exp(s) + t` with
/// constant `s` and `t`.
///
/// What is *not* bounded is the shear: `J_jl` grows with `x_j` unless `s` is constant. With `B = 0`
/// the map keeps volumes and its Jacobian is bounded.
///
/// # Numerics
/// The inverse is exact to a few `epsilon` times `|y_j| + |t|`, magnified by `exp(-s)`. Results that
/// are too large for `T` are infinite.
///
/// # References
/// L. Dinh, J. Sohl-Dickstein, S. Bengio, "Density estimation using Real NVP", ICLR 2017, equations
/// (4) to (8); with sums of bumps in place of networks.
///
/// # Examples
/// ```
/// use ddl_dynamics::{AffineCoupling, CouplingBump, Diffeomorphism};
/// use nalgebra::Vector2;
///
/// // Lifts the plane by 2 m around x = 1, and stretches its height there by e^(tanh 0.5).
/// let bump = CouplingBump {
///     centre: Vector2::new(1.0, 0.0),
///     rate: 1.0,
///     log_scale: 0.5,
///     shift: 2.0,
/// };
/// let map = AffineCoupling::new(1, 1.0, vec![bump])?;
/// assert_eq!(map.apply(&Vector2::new(1.0, 0.0)), Vector2::new(1.0, 2.0));
/// assert_eq!(map.inverse(&Vector2::new(1.0, 2.0)), Vector2::new(1.0, 0.0));
/// let determinant = map.jacobian(&Vector2::new(1.0, 7.0)).determinant();
/// assert!((determinant - 0.5_f64.tanh().exp()).abs() < 1e-15);
/// # Ok::<(), ddl_dynamics::DynamicsError>(())
/// ```
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(
    try_from = "Unchecked<T, D>",
    bound(
        serialize = "T: Real + Serialize",
        deserialize = "T: Real + Deserialize<'de>"
    )
)]
pub struct AffineCoupling<T, const D: usize> {
    moved: usize,
    largest_log_scale: T,
    bumps: Vec<CouplingBump<T, D>>,
}

/// What a file says, before the checks.
#[derive(Deserialize)]
#[serde(deny_unknown_fields, bound(deserialize = "T: Real + Deserialize<'de>"))]
struct Unchecked<T, const D: usize> {
    moved: usize,
    largest_log_scale: T,
    bumps: Vec<CouplingBump<T, D>>,
}

impl<T: Real, const D: usize> TryFrom<Unchecked<T, D>> for AffineCoupling<T, D> {
    type Error = DynamicsError;

    fn try_from(unchecked: Unchecked<T, D>) -> Result<Self, DynamicsError> {
        Self::new(
            unchecked.moved,
            unchecked.largest_log_scale,
            unchecked.bumps,
        )
    }
}

/// `s` and `t` at a point, and their gradients (0 along the moved coordinate).
struct Coupled<T, const D: usize> {
    log_scale: T,
    shift: T,
    log_scale_gradient: SVector<T, D>,
    shift_gradient: SVector<T, D>,
}

impl<T: Real, const D: usize> AffineCoupling<T, D> {
    /// The largest value of `B` accepted: scales from `exp(-10)` to `exp(10)`, about 22,000.
    pub const MAX_LOG_SCALE: f64 = 10.0;

    /// The map that moves coordinate `moved` (from 0), with `B = largest_log_scale` (no unit).
    /// Without bumps it is the identity.
    ///
    /// # Errors
    /// - [`DynamicsError::NoSuchCoordinate`]: `moved` is not below `D`.
    /// - [`DynamicsError::InvalidLogScale`]: `B` is not between 0 and
    ///   [`MAX_LOG_SCALE`](Self::MAX_LOG_SCALE).
    /// - [`DynamicsError::NonFinite`], [`DynamicsError::InvalidRate`]: a parameter of a bump.
    /// - [`DynamicsError::BumpsTooLarge`]: the sum of all weights, or of all weights times their
    ///   rates, overflows.
    pub fn new(
        moved: usize,
        largest_log_scale: T,
        bumps: Vec<CouplingBump<T, D>>,
    ) -> Result<Self, DynamicsError> {
        if moved >= D {
            return Err(DynamicsError::NoSuchCoordinate {
                coordinate: moved,
                dimension: D,
            });
        }
        let accepted = T::zero()..=T::rounded(Self::MAX_LOG_SCALE);
        if !accepted.contains(&largest_log_scale) {
            return Err(DynamicsError::InvalidLogScale {
                value: largest_log_scale.as_f64(),
                largest: Self::MAX_LOG_SCALE,
            });
        }
        let mut sum = T::zero();
        for bump in &bumps {
            ensure_finite("centre of a bump", &bump.centre)?;
            ensure_finite(
                "weights (log scale, shift) of a bump",
                &SVector::<T, 2>::new(bump.log_scale, bump.shift),
            )?;
            gaussian::ensure_rate(bump.rate)?;
            let weight = bump.log_scale.abs() + bump.shift.abs();
            sum += weight + weight * bump.rate;
        }
        // The factors that the sums meet in the map and its Jacobian are at most 2 B < 32.
        if !(sum * T::rounded(32.0)).is_finite() {
            return Err(DynamicsError::BumpsTooLarge);
        }
        Ok(Self {
            moved,
            largest_log_scale,
            bumps,
        })
    }

    /// The coordinate that is moved, from 0.
    pub fn moved(&self) -> usize {
        self.moved
    }

    /// `B`: the logarithm of the scale is never larger than this, nor below its negative (no unit).
    pub fn largest_log_scale(&self) -> T {
        self.largest_log_scale
    }

    /// The bumps.
    pub fn bumps(&self) -> &[CouplingBump<T, D>] {
        &self.bumps
    }

    /// `exp(-B)`: `det J` is nowhere below it (no unit).
    pub fn determinant_lower_bound(&self) -> T {
        (-self.largest_log_scale).exp()
    }

    /// Everything the map needs to know at a point, of which it reads the rest alone.
    fn coupled(&self, point: &SVector<T, D>) -> Coupled<T, D> {
        let (mut weight, mut shift) = (T::zero(), T::zero());
        let mut weight_gradient = SVector::zeros();
        let mut shift_gradient = SVector::zeros();
        for bump in &self.bumps {
            let mut offset = gaussian::scaled_offset(point, &bump.centre, bump.rate);
            offset[self.moved] = T::zero();
            let height = gaussian::height(&offset);
            if height.is_zero() {
                // The offset may be infinite, and 0 times it NaN.
                continue;
            }
            weight += bump.log_scale * height;
            shift += bump.shift * height;
            let slope = offset * -(height + height);
            weight_gradient += slope * (bump.log_scale * bump.rate);
            shift_gradient += slope * (bump.shift * bump.rate);
        }
        let bounded = weight.tanh();
        let steepness = self.largest_log_scale * (T::one() - bounded * bounded);
        Coupled {
            log_scale: self.largest_log_scale * bounded,
            shift,
            log_scale_gradient: weight_gradient * steepness,
            shift_gradient,
        }
    }
}

impl<T: Real, const D: usize> Diffeomorphism<T, D> for AffineCoupling<T, D> {
    fn apply(&self, position: &SVector<T, D>) -> SVector<T, D> {
        self.apply_with_jacobian(position).0
    }

    fn inverse(&self, image: &SVector<T, D>) -> SVector<T, D> {
        let coupled = self.coupled(image);
        let mut position = *image;
        position[self.moved] = (image[self.moved] - coupled.shift) * (-coupled.log_scale).exp();
        position
    }

    fn jacobian(&self, position: &SVector<T, D>) -> SMatrix<T, D, D> {
        self.apply_with_jacobian(position).1
    }

    fn apply_with_jacobian(&self, position: &SVector<T, D>) -> (SVector<T, D>, SMatrix<T, D, D>) {
        let coupled = self.coupled(position);
        let scale = coupled.log_scale.exp();
        let mut image = *position;
        image[self.moved] = position[self.moved] * scale + coupled.shift;
        let mut jacobian = SMatrix::identity();
        for column in 0..D {
            // In this order an overflow is never multiplied by 0.
            let sheared = position[self.moved] * coupled.log_scale_gradient[column] * scale;
            jacobian[(self.moved, column)] = sheared + coupled.shift_gradient[column];
        }
        jacobian[(self.moved, self.moved)] = scale;
        (image, jacobian)
    }
}
