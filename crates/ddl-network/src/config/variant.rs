//! The four variants of the paper's ablation, and the backbones.

use ddl_core::named;
use serde::{Deserialize, Serialize};

/// The four rows of the paper's Table II: goal shift (A) and dynamics (B), each on or off.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Variant {
    /// Goal shift and dynamics: the method of the paper.
    Full,
    /// Dynamics without goal shift.
    NoGoalShift,
    /// Goal shift without dynamics.
    NoDynamics,
    /// Neither: plain STAR.
    Star,
}

impl Variant {
    /// Whether the temporal encoders read positions relative to the goal (eq. 10). If not: relative to the last
    /// observed position.
    pub fn goal_shift(self) -> bool {
        matches!(self, Self::Full | Self::NoDynamics)
    }

    /// Whether the output is the Cholesky factor of the metric (eq. 12). If not, it is the next position.
    pub fn dynamics(self) -> bool {
        matches!(self, Self::Full | Self::NoGoalShift)
    }

    /// Whether a forecast depends on a goal.
    pub fn uses_goal(self) -> bool {
        self != Self::Star
    }
}

// In the order of the paper's Table II.
named!(Variant, "variant", Star => "star", NoGoalShift => "no-goal-shift", NoDynamics => "no-dynamics", Full => "full");

/// The network behind the shared rollout, which turns observed and forecast positions into features.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum BackboneKind {
    /// The spatio-temporal Transformer of the paper.
    #[default]
    Star,
    /// A small perceptron on the goal offset and the observed velocities, without interaction between pedestrians.
    Perceptron,
}

named!(BackboneKind, "backbone", Star => "star", Perceptron => "perceptron");
