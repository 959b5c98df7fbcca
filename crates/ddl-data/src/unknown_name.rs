//! Parsing of a word that must be one of a fixed set.

use thiserror::Error;

/// A word outside a fixed set, with the words allowed.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[error("{found:?} is not a known {kind}; choose one of {expected}")]
pub struct UnknownName {
    /// What the word should name, such as `data convention`.
    pub kind: &'static str,
    /// The word found.
    pub found: String,
    /// The words allowed.
    pub expected: &'static str,
}

impl UnknownName {
    /// The member of `all` whose name is `word`.
    ///
    /// # Errors
    /// If no member has this name.
    pub fn find<T: Copy>(
        word: &str,
        members: &[T],
        name: fn(T) -> &'static str,
        kind: &'static str,
        expected: &'static str,
    ) -> Result<T, Self> {
        let member = members.iter().copied().find(|&one| name(one) == word);
        member.ok_or_else(|| Self {
            kind,
            found: word.to_owned(),
            expected,
        })
    }
}
