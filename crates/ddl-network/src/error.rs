//! What can go wrong in this crate.

use std::path::{Path, PathBuf};

/// Errors of `ddl-network`. Messages say what is wrong, where, and what to do.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum NetworkError {
    /// A configuration value is outside its range.
    #[error("configuration: {field} = {value} is not allowed: {rule}")]
    Config {
        /// Name of the field.
        field: &'static str,
        /// The value given.
        value: String,
        /// What is allowed.
        rule: &'static str,
    },
    /// Windows, goals or tensors of unexpected size.
    #[error("{operation}: expected {expected}, got {got}")]
    Shape {
        /// The operation that found it.
        operation: &'static str,
        /// What the operation needs.
        expected: String,
        /// What it was given.
        got: String,
    },
    /// A checkpoint that must not be trusted.
    #[error("checkpoint {}: {problem}", path.display())]
    Checkpoint {
        /// The file.
        path: PathBuf,
        /// What is wrong with it, and what to do.
        problem: String,
    },
    /// A learned tensor that cannot be rounded, or does not belong to the network it is given to.
    #[error("weights: {tensor} {problem}")]
    Weights {
        /// Name of the tensor.
        tensor: String,
        /// What is wrong with it, and what to do.
        problem: String,
    },
    /// Reading or writing a file failed.
    #[error("{}: {source}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// The implementation that computes the network failed.
    #[error("{0}")]
    Backend(Box<dyn std::error::Error + Send + Sync>),
}

impl NetworkError {
    pub(crate) fn io(path: &Path) -> impl FnOnce(std::io::Error) -> Self + Copy + '_ {
        move |source| Self::Io {
            path: path.to_owned(),
            source,
        }
    }

    /// A checkpoint that must not be trusted.
    pub fn checkpoint(path: &Path, problem: impl Into<String>) -> Self {
        Self::Checkpoint {
            path: path.to_owned(),
            problem: problem.into(),
        }
    }

    pub(crate) fn weights(tensor: &str, problem: impl Into<String>) -> Self {
        Self::Weights {
            tensor: tensor.to_owned(),
            problem: problem.into(),
        }
    }

    /// Windows, goals or tensors of unexpected size.
    pub fn shape(
        operation: &'static str,
        expected: impl Into<String>,
        got: impl Into<String>,
    ) -> Self {
        Self::Shape {
            operation,
            expected: expected.into(),
            got: got.into(),
        }
    }
}
