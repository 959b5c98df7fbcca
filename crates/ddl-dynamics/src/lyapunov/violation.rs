//! Violations of the stability guarantee.

use serde::{Deserialize, Serialize};
use thiserror::Error;

/// The first violation of the stability guarantee in a rollout.
#[derive(Debug, Clone, PartialEq, Error, Serialize, Deserialize)]
#[serde(tag = "violation", rename_all = "kebab-case")]
#[non_exhaustive]
#[expect(missing_docs, reason = "the messages say what the fields are")]
pub enum Violation {
    #[error("step {step} does not approach the goal: {before} m away before it, {after} m after it")]
    NotDecreasing { step: usize, before: f64, after: f64 },
    #[error("step {step} leaves the goal: {after} m away after it")]
    LeftGoal { step: usize, after: f64 },
    /// The metric of the step is not positive definite; occurs only in certificates of other programs.
    #[error("the metric of step {step} is not positive definite: smallest eigenvalue {min_eigenvalue}")]
    NotPositiveDefinite { step: usize, min_eigenvalue: f64 },
    /// The potential does not fall along the flow; occurs only in certificates of other programs.
    #[error("the flow does not descend in step {step}: the distance changes at {rate} m/s")]
    NotDescending { step: usize, rate: f64 },
    #[error("the {figure} is {value}, more than its bound {bound}")]
    OutOfBounds { figure: String, value: f64, bound: f64 },
}
