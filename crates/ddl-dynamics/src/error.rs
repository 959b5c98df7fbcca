//! What can be wrong with the input of this crate.

use thiserror::Error;

use crate::real::Real;

/// An input that has no meaning for a stable flow; nothing in this crate panics on it.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
#[expect(missing_docs, reason = "the messages say what the fields are")]
pub enum DynamicsError {
    /// A number is NaN or infinite.
    #[error("{entry} is {value}: it must be a finite number")]
    NonFinite { entry: String, value: f64 },

    /// A number that has to be positive and finite is not.
    #[error("{quantity} is {value}{unit}: it must be positive and finite")]
    NotPositive {
        quantity: &'static str,
        unit: &'static str,
        value: f64,
    },

    /// A Cholesky factor has a non-zero entry above its diagonal.
    #[error(
        "entry ({row}, {column}) of the Cholesky factor is {value}: entries above the diagonal must be 0"
    )]
    NotLowerTriangular {
        row: usize,
        column: usize,
        value: f64,
    },

    /// The squares of a Cholesky factor do not fit into the number type.
    #[error("the Cholesky factor is too large: L L^T overflows; scale the factor down or use f64")]
    FactorTooLarge,

    /// A linear map cannot be inverted.
    #[error("the map is not finite or has no inverse: P seen through it is not positive definite")]
    SingularMap,

    /// The share of a velocity that is to be left is not in (0, 1].
    #[error("the share is {0}: it must be above 0, or P is not positive definite, and at most 1")]
    InvalidShare(f64),

    /// A direction is the zero vector.
    #[error("the direction is the zero vector: it must have a length")]
    NoDirection,

    /// An adaptive integrator needs too many inner steps.
    #[error(
        "the flow is too stiff: {steps} inner steps were not enough for {covered} s of a time step; \
         use StableEuler, a larger tolerance or a shorter time step"
    )]
    TooStiff { steps: usize, covered: f64 },

    /// The distance to the goal does not fit into the number type.
    #[error("the distance from the position to the goal overflows; use smaller units or f64")]
    DistanceTooLarge,

    /// A local translation moves points further than its bump is wide.
    #[error(
        "the local translation is not invertible: sqrt(2/e) rho |v| is {contraction}, and must be at most {largest}; shorten the translation v or lower the rate rho"
    )]
    NotInvertible { contraction: f64, largest: f64 },

    /// A path to be straightened leads nowhere.
    #[error(
        "a path of {points} points and {length} m cannot be straightened: it needs two different points at least, and a length that is a finite number"
    )]
    InvalidPathLength { points: usize, length: f64 },

    /// A path to be straightened runs back along itself, which no invertible map can straighten.
    #[error(
        "the path turns back on itself {along:.2} m after its start: straighten the parts before and after it, or round the turn"
    )]
    PathTurnsBack { along: f64 },

    /// A schedule of metrics holds none.
    #[error("the metric schedule is empty: it needs the metric of at least one step")]
    EmptySchedule,

    /// Positions and metrics of a certificate do not belong together.
    #[error(
        "{positions} positions and {metrics} metrics: a rollout of n steps has n + 1 positions and n metrics"
    )]
    LengthMismatch { positions: usize, metrics: usize },

    /// A position is not the one that a certificate is of.
    #[error(
        "position {position} is not as far from the goal as the certificate says: it is of another path or goal"
    )]
    OtherPath { position: usize },

    /// A step of a rollout failed.
    #[error("step {step} of the rollout failed: {cause}")]
    Step {
        step: usize,
        #[source]
        cause: Box<DynamicsError>,
    },
}

/// `vector` itself if every component is finite.
#[inline]
pub(crate) fn ensure_finite<'a, T: Real, const D: usize>(
    quantity: &'static str,
    vector: &'a nalgebra::SVector<T, D>,
) -> Result<&'a nalgebra::SVector<T, D>, DynamicsError> {
    match vector.iter().position(|x| !x.is_finite()) {
        None => Ok(vector),
        Some(component) => Err(DynamicsError::NonFinite {
            entry: format!("component {component} of the {quantity}"),
            value: vector[component].as_f64(),
        }),
    }
}

/// `value` itself if it is positive and finite.
#[inline]
pub(crate) fn ensure_positive<T: Real>(
    quantity: &'static str,
    unit: &'static str,
    value: T,
) -> Result<T, DynamicsError> {
    if value > T::zero() && value.is_finite() {
        Ok(value)
    } else {
        Err(DynamicsError::NotPositive {
            quantity,
            unit,
            value: value.as_f64(),
        })
    }
}

/// `dt` itself if it is a time step: positive and finite.
#[inline]
pub(crate) fn ensure_time_step<T: Real>(dt: T) -> Result<T, DynamicsError> {
    ensure_positive("the time step", " s", dt)
}
