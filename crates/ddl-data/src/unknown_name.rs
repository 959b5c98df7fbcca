//! A word that should be one of a few.

use thiserror::Error;

/// A word that names no member of a fixed set, with the words that do.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[error("{found:?} is no {kind}; choose one of {expected}")]
pub struct UnknownName {
    /// What was to be named, such as `data convention`.
    pub kind: &'static str,
    /// The word found.
    pub found: String,
    /// The words allowed.
    pub expected: &'static str,
}

impl UnknownName {
    /// The one of `all` that is called `word`.
    ///
    /// # Errors
    /// None is.
    pub fn find<T: Copy>(
        word: &str,
        all: &[T],
        name: fn(T) -> &'static str,
        kind: &'static str,
        expected: &'static str,
    ) -> Result<T, Self> {
        let found = all.iter().copied().find(|&one| name(one) == word);
        found.ok_or_else(|| Self {
            kind,
            found: word.to_owned(),
            expected,
        })
    }
}
