//! One step of a certificate: its quantities and their check.

use super::Violation;
use crate::{attractor::Attractor, metric::CholeskyMetric, polar::polar, real::Real};
use nalgebra::SVector;
use serde::{Deserialize, Serialize};

/// The evidence of one step, from position `k` to position `k + 1`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct CertifiedStep<T> {
    /// `Phi`: the distance to the goal at the start of the step (metres).
    pub potential: T,
    /// `d Phi / dt = -u^T P u` at the start of the step (m/s); 0 only at the goal. A value too small for `T` is
    /// replaced by the smallest normal number.
    pub rate: T,
    /// The smallest eigenvalue of the step's metric (m/s).
    pub min_eigenvalue: T,
    /// `1 - dt / dt_max`, where `dt_max = -2 Phi (d Phi / dt) / |v|^2` is the bound below which a plain Euler step
    /// lowers `Phi` (no unit). `None` at the goal, where every step is too long.
    pub step_margin: Option<T>,
    /// Angle between the move and the direction to the goal (radians, 0 to pi); 0 without a move.
    pub angle: T,
}

impl<T: Real> CertifiedStep<T> {
    pub(super) fn new<const D: usize>(
        from: &SVector<T, D>,
        to: &SVector<T, D>,
        metric: &CholeskyMetric<T, D>,
        attractor: &Attractor<T, D>,
        dt: T,
    ) -> Self {
        let (potential, away) = attractor.distance_and_gradient(from);
        let mut descent = metric.quadratic_form(&away);
        if descent.is_zero() && !potential.is_zero() {
            // It is positive, but may underflow.
            descent = T::MIN_POSITIVE;
        }
        let (speed, _) = polar(&metric.apply(&away));
        // Divided twice: the square of the speed could overflow or underflow.
        let bound = potential * (descent / speed) / speed * T::rounded(2.0);
        let step_margin = Some(T::one() - dt / bound).filter(T::is_finite);
        let (_, heading) = polar(&(to - from));
        Self {
            potential,
            rate: -descent,
            min_eigenvalue: metric.eigenvalue_range().smallest,
            step_margin,
            angle: angle_between(&heading, &-away),
        }
    }

    pub(super) fn check(&self, step: usize, after: T) -> Result<(), Violation> {
        let (before, rate) = (self.potential.as_f64(), self.rate.as_f64());
        let (min_eigenvalue, after) = (self.min_eigenvalue.as_f64(), after.as_f64());
        // Written so that NaN also violates the guarantee. Certificates made here hold no NaN.
        let (definite, descending) = (min_eigenvalue > 0.0, rate < 0.0);
        match (before == 0.0, after == 0.0) {
            _ if !definite => Err(Violation::NotPositiveDefinite { step, min_eigenvalue }),
            (true, true) => Ok(()),
            (true, false) => Err(Violation::LeftGoal { step, after }),
            _ if !descending => Err(Violation::NotDescending { step, rate }),
            _ if after < before => Ok(()),
            _ => Err(Violation::NotDecreasing { step, before, after }),
        }
    }
}

/// Angle between two unit vectors (radians); 0 if one of them is the zero vector. Kahan's form is accurate for small
/// angles and near 180 degrees.
fn angle_between<T: Real, const D: usize>(a: &SVector<T, D>, b: &SVector<T, D>) -> T {
    let zero = SVector::<T, D>::zeros();
    if *a == zero || *b == zero {
        return T::zero();
    }
    (a - b).norm().atan2((a + b).norm()) * T::rounded(2.0)
}
