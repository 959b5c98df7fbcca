//! Which network stands behind the shared rollout.

use crate::NetworkError;
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

    /// The name used on the command line and in reports.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Star => "star",
            Self::Perceptron => "perceptron",
        }
    }
}

impl std::fmt::Display for BackboneKind {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.name())
    }
}

impl std::str::FromStr for BackboneKind {
    type Err = NetworkError;

    fn from_str(text: &str) -> Result<Self, NetworkError> {
        Self::ALL
            .into_iter()
            .find(|kind| kind.name() == text)
            .ok_or_else(|| NetworkError::Config {
                field: "backbone",
                value: text.to_owned(),
                rule: "one of star, perceptron",
            })
    }
}
