//! Errors of this crate.

use std::path::{Path, PathBuf};

/// Errors of `ddl-network`.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
#[expect(missing_docs, reason = "the messages describe the variants")]
pub enum NetworkError {
    #[error("configuration: {field} = {value} is not allowed: {rule}")]
    Config { field: &'static str, value: String, rule: &'static str },
    #[error("{operation}: expected {expected}, got {got}")]
    Shape { operation: &'static str, expected: String, got: String },
    #[error("checkpoint {}: {problem}", path.display())]
    Checkpoint { path: PathBuf, problem: String },
    #[error("weights: {tensor} {problem}")]
    Weights { tensor: String, problem: String },
    #[error("{}: {source}", path.display())]
    Io { path: PathBuf, source: std::io::Error },
    #[error("{0}")]
    Backend(Box<dyn std::error::Error + Send + Sync>),
}

impl NetworkError {
    pub(crate) fn io(path: &Path) -> impl FnOnce(std::io::Error) -> Self + Copy + '_ {
        move |source| Self::Io { path: path.to_owned(), source }
    }

    /// An error about a checkpoint that cannot be read or is damaged.
    pub fn checkpoint(path: &Path, problem: impl Into<String>) -> Self {
        Self::Checkpoint { path: path.to_owned(), problem: problem.into() }
    }

    pub(crate) fn weights(tensor: &str, problem: impl Into<String>) -> Self {
        Self::Weights { tensor: tensor.to_owned(), problem: problem.into() }
    }

    /// An error about windows, goals or tensors of unexpected shape.
    pub fn shape(operation: &'static str, expected: impl Into<String>, got: impl Into<String>) -> Self {
        Self::Shape { operation, expected: expected.into(), got: got.into() }
    }
}
