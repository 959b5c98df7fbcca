//! The choice between test scene and validation part.

use serde::{Deserialize, Serialize};

/// The windows to evaluate on.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Split {
    /// The scene left out of training.
    Test,
    /// The last part of the training recordings, kept out of training for validation.
    Validation,
}
