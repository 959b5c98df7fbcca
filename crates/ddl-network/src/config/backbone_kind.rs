//! Which network stands behind the shared rollout.

use crate::names::named;
use serde::{Deserialize, Serialize};

/// The network behind the shared rollout: what turns observed and forecast positions into features, of which the output
/// layer makes the metric of each step.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum BackboneKind {
    /// The spatio-temporal Transformer of the paper.
    #[default]
    Star,
    /// A small perceptron on the goal offset and the observed velocities; pedestrians do not see each other.
    Perceptron,
}

impl BackboneKind {
    /// All of them.
    pub const ALL: [Self; 2] = [Self::Star, Self::Perceptron];
}

named!(BackboneKind, "backbone", Star => "star", Perceptron => "perceptron");
