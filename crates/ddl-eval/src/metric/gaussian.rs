//! Mean, covariance and principal axes of weighted points in the plane.
//!
//! For points `x_k` with weights `w_k` that sum to 1:
//!
//! ```text
//! m = sum_k w_k x_k                         metres
//! C = sum_k w_k (x_k - m) (x_k - m)^T       square metres (not the unbiased estimate)
//! ```

use ddl_core::Position;

/// A symmetric 2 x 2 matrix, square metres.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct PlaneCovariance {
    /// Variance along x.
    pub xx: f64,
    /// Covariance of x and y.
    pub xy: f64,
    /// Variance along y.
    pub yy: f64,
}

impl PlaneCovariance {
    /// Every entry times `factor` (no unit).
    #[must_use]
    pub(crate) fn scaled(self, factor: f64) -> Self {
        Self { xx: factor * self.xx, xy: factor * self.xy, yy: factor * self.yy }
    }

    /// The sum of both covariances.
    #[must_use]
    pub(crate) fn plus(self, other: Self) -> Self {
        Self { xx: self.xx + other.xx, xy: self.xy + other.xy, yy: self.yy + other.yy }
    }

    /// Eigenvalues, the larger first, and the unit eigenvector of the larger one.
    pub(crate) fn principal_axes(self) -> PrincipalAxes {
        let (mean, half) = (0.5 * (self.xx + self.yy), 0.5 * (self.xx - self.yy));
        let radius = half.hypot(self.xy);
        let (sin, cos) = (0.5 * self.xy.atan2(half)).sin_cos();
        PrincipalAxes { variances: [mean + radius, mean - radius], axis: [cos, sin] }
    }
}

/// A covariance along its own axes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct PrincipalAxes {
    /// The eigenvalues, the larger first, square metres.
    pub variances: [f64; 2],
    /// Unit eigenvector of the larger one.
    pub axis: Position,
}

impl PrincipalAxes {
    /// The same axes, with eigenvalues below `least` (square metres) raised to it, so that an inverse exists.
    #[must_use]
    pub(crate) fn with_least_eigenvalues(self, least: f64) -> Self {
        Self { variances: self.variances.map(|variance| variance.max(least)), ..self }
    }

    /// The matrix that has these axes.
    pub(crate) fn covariance(self) -> PlaneCovariance {
        let ([large, small], [cos, sin]) = (self.variances, self.axis);
        PlaneCovariance {
            xx: large * cos * cos + small * sin * sin,
            xy: (large - small) * cos * sin,
            yy: large * sin * sin + small * cos * cos,
        }
    }

    /// `d^T C^-1 d`: the squared Mahalanobis length of a difference of positions; no unit.
    pub(crate) fn mahalanobis_squared(self, d: Position) -> f64 {
        let [cos, sin] = self.axis;
        let (along, across) = (cos * d[0] + sin * d[1], cos * d[1] - sin * d[0]);
        along * along / self.variances[0] + across * across / self.variances[1]
    }

    /// `ln det C`, with C in square metres.
    pub(crate) fn ln_determinant(self) -> f64 {
        self.variances[0].ln() + self.variances[1].ln()
    }
}

/// Mean and covariance of weighted points.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct PointMoments {
    /// The mean, metres.
    pub mean: Position,
    /// The covariance, square metres.
    pub covariance: PlaneCovariance,
}

impl PointMoments {
    /// The moments of points with weights that sum to 1.
    ///
    /// # Panics
    /// When the numbers of weights and points differ.
    pub(crate) fn of(points: &[Position], weights: &[f64]) -> Self {
        assert_eq!(points.len(), weights.len(), "one weight a point");
        let weighted = || points.iter().zip(weights);
        let mean = weighted().fold([0.0, 0.0], |m, (p, w)| [m[0] + w * p[0], m[1] + w * p[1]]);
        let covariance = weighted().fold(PlaneCovariance::default(), |c, (p, w)| {
            let d = [p[0] - mean[0], p[1] - mean[1]];
            c.plus(PlaneCovariance { xx: w * d[0] * d[0], xy: w * d[0] * d[1], yy: w * d[1] * d[1] })
        });
        Self { mean, covariance }
    }
}
