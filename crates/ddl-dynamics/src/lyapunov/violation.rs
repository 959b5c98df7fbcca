//! What a certificate says of a rollout that broke the guarantee.

use serde::{Deserialize, Serialize};
use thiserror::Error;

/// The first step of a rollout that broke the guarantee.
#[derive(Debug, Clone, PartialEq, Error, Serialize, Deserialize)]
#[serde(tag = "violation", rename_all = "kebab-case")]
#[non_exhaustive]
pub enum Violation {
    /// The walker was on its way and did not come closer to the goal.
    #[error(
        "step {step} does not approach the goal: {before} m away before it, {after} m after it"
    )]
    NotDecreasing {
        /// Index of the step, from 0.
        step: usize,
        /// Distance to the goal before the step (metres).
        before: f64,
        /// Distance to the goal after the step (metres).
        after: f64,
    },
    /// The walker had arrived and left again.
    #[error("step {step} leaves the goal: {after} m away after it")]
    LeftGoal {
        /// Index of the step, from 0.
        step: usize,
        /// Distance to the goal after the step (metres).
        after: f64,
    },
    /// The metric of the step is not positive definite. No [`CholeskyMetric`](crate::CholeskyMetric) is like this; a
    /// certificate read from elsewhere may say so.
    #[error(
        "the metric of step {step} is not positive definite: smallest eigenvalue {min_eigenvalue}"
    )]
    NotPositiveDefinite {
        /// Index of the step, from 0.
        step: usize,
        /// The smallest eigenvalue (m/s).
        min_eigenvalue: f64,
    },
    /// The potential does not fall along the flow. As for
    /// [`NotPositiveDefinite`](Self::NotPositiveDefinite), only a certificate from elsewhere.
    #[error("the flow does not descend in step {step}: the distance changes at {rate} m/s")]
    NotDescending {
        /// Index of the step, from 0.
        step: usize,
        /// `d Phi / dt` (m/s).
        rate: f64,
    },
    /// A figure of the motion exceeds the bound that was set to it.
    #[error("the {figure} is {value}, more than its bound {bound}")]
    OutOfBounds {
        /// Which figure, with its unit.
        figure: String,
        /// What it reached.
        value: f64,
        /// What it was to stay within.
        bound: f64,
    },
}
