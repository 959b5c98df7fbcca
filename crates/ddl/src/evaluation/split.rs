use serde::{Deserialize, Serialize};

/// Which windows to measure on.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum EvaluationSplit {
    /// The scene left out of training.
    Test,
    /// The last part of the training recordings, kept out of training for choices to be made on.
    Validation,
}
