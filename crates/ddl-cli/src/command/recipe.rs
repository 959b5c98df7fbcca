//! The recipes of a training.

use clap::ValueEnum;
use serde::{Deserialize, Serialize};
use std::fmt;

/// The values of `--recipe`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum Recipe {
    /// Training on whole paths to estimated goals; minutes on a CPU.
    Recommended,
    /// The paper's training on single steps; hours.
    Published,
}

impl fmt::Display for Recipe {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.to_possible_value().ok_or(fmt::Error)?.get_name())
    }
}
