//! Errors of this crate.

use crate::real::Real;
use nalgebra::SVector;
use thiserror::Error;

/// An invalid input. This crate does not panic on invalid input.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
#[expect(missing_docs, reason = "the messages say what the fields are")]
pub enum DynamicsError {
    #[error("{entry} is {value}: it must be a finite number")]
    NonFinite { entry: String, value: f64 },
    #[error("{quantity} is {value}{unit}: it must be positive and finite")]
    NotPositive { quantity: &'static str, unit: &'static str, value: f64 },
    #[error("entry ({row}, {column}) of the Cholesky factor is {value}: entries above the diagonal must be 0")]
    NotLowerTriangular { row: usize, column: usize, value: f64 },
    #[error("the Cholesky factor is too large: L L^T overflows; scale the factor down or use f64")]
    FactorTooLarge,
    #[error("the distance from the position to the goal overflows; use smaller units or f64")]
    DistanceTooLarge,
    #[error("the metric schedule is empty: give the metric of at least one step")]
    EmptySchedule,
    #[error("{positions} positions and {metrics} metrics: a rollout of n steps has n + 1 positions and n metrics")]
    LengthMismatch { positions: usize, metrics: usize },
    #[error(
        "the distance of position {position} from the goal differs from the certificate: \
         the path or the goal is another one"
    )]
    OtherPath { position: usize },
    #[error("step {step} of the rollout failed: {cause}")]
    Step {
        step: usize,
        #[source]
        cause: Box<DynamicsError>,
    },
}

#[inline]
pub(crate) fn ensure_finite<T: Real, const D: usize>(
    quantity: &str,
    vector: &SVector<T, D>,
) -> Result<(), DynamicsError> {
    match vector.iter().position(|x| !x.is_finite()) {
        None => Ok(()),
        Some(component) => Err(DynamicsError::NonFinite {
            entry: format!("component {component} of the {quantity}"),
            value: vector[component].as_f64(),
        }),
    }
}

#[inline]
pub(crate) fn ensure_positive<T: Real>(
    quantity: &'static str,
    unit: &'static str,
    value: T,
) -> Result<(), DynamicsError> {
    if value > T::zero() && value.is_finite() {
        Ok(())
    } else {
        Err(DynamicsError::NotPositive { quantity, unit, value: value.as_f64() })
    }
}

#[inline]
pub(crate) fn ensure_time_step<T: Real>(dt: T) -> Result<(), DynamicsError> {
    ensure_positive("the time step", " s", dt)
}
