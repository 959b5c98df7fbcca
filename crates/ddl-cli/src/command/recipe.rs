use clap::ValueEnum;
use serde::{Deserialize, Serialize};
use std::fmt;

/// What `--recipe` takes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum Recipe {
    /// Whole walks to estimated goals, in minutes on a CPU.
    Recommended,
    /// The paper's: single steps, in hours.
    Published,
}

impl fmt::Display for Recipe {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.to_possible_value().ok_or(fmt::Error)?.get_name())
    }
}
