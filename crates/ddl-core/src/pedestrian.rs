//! Pedestrians: their numbers, and how files and streams name them, by numbers or by words such as UUIDs.

use std::collections::BTreeMap;
use std::fmt;
use std::sync::Arc;

use serde::{Deserialize, Serialize};

/// The number of a pedestrian, unique only within its recording.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(transparent)]
pub struct PedestrianId(pub i64);

impl fmt::Display for PedestrianId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.fmt(f)
    }
}

/// The name of a pedestrian in a file or stream.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(untagged)]
pub enum PedestrianName {
    /// A number.
    Number(i64),
    /// Any other text, as written.
    Word(String),
}

impl PedestrianName {
    /// Interprets a text: a number if it is written as that number is printed, else a word.
    #[must_use]
    pub fn of_text(text: &str) -> Self {
        match text.parse::<i64>() {
            Ok(number) if is_plain(text) => Self::Number(number),
            _ => Self::Word(text.to_owned()),
        }
    }
}

impl From<PedestrianId> for PedestrianName {
    fn from(id: PedestrianId) -> Self {
        Self::Number(id.0)
    }
}

impl fmt::Display for PedestrianName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Number(number) => number.fmt(f),
            Self::Word(word) => word.fmt(f),
        }
    }
}

/// Whether a whole number is written as it is printed, without `+`, leading zeros or decimals.
fn is_plain(number: &str) -> bool {
    let digits = number.strip_prefix('-').unwrap_or(number);
    digits.bytes().all(|byte| byte.is_ascii_digit()) && (number == "0" || !digits.starts_with('0'))
}

/// The words that a recording or window uses for its pedestrians; empty where the file uses numbers.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct PedestrianNames(Option<Arc<BTreeMap<PedestrianId, Arc<str>>>>);

impl PedestrianNames {
    /// Names of these pedestrians; the others are named by their numbers.
    pub fn new(words: BTreeMap<PedestrianId, Arc<str>>) -> Self {
        Self((!words.is_empty()).then(|| Arc::new(words)))
    }

    /// The names of the pedestrians that are kept, and newer ones.
    #[must_use]
    pub fn updated(&self, newer: &Self, is_kept: impl Fn(PedestrianId) -> bool) -> Self {
        let [older, newer] = [self, newer].map(|names| names.0.as_deref().into_iter().flatten());
        let words = older.filter(|(id, _)| is_kept(**id)).chain(newer);
        Self::new(words.map(|(id, word)| (*id, Arc::clone(word))).collect())
    }

    fn word(&self, id: PedestrianId) -> Option<&str> {
        self.0.as_ref()?.get(&id).map(AsRef::as_ref)
    }

    /// The name of a pedestrian in the file.
    #[must_use]
    pub fn of(&self, id: PedestrianId) -> PedestrianName {
        match self.word(id) {
            Some(word) => PedestrianName::Word(word.to_owned()),
            None => id.into(),
        }
    }

    /// Whether a pedestrian has this name, in any spelling of a number.
    pub(crate) fn names(&self, id: PedestrianId, name: &PedestrianName) -> bool {
        match (self.word(id), name) {
            (None, PedestrianName::Number(number)) => id.0 == *number,
            (Some(word), PedestrianName::Word(name)) => word == name,
            (Some(word), PedestrianName::Number(number)) => word == number.to_string(),
            #[expect(clippy::float_cmp, reason = "whole numbers below 2^53 are exact")]
            (None, PedestrianName::Word(name)) => name.parse::<f64>().is_ok_and(|number| number == id.0 as f64),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn numbers_and_words_come_back_as_they_were_written(text in "[-+0-9a-c.]{1,5}") {
            prop_assert_eq!(PedestrianName::of_text(&text).to_string(), text);
        }
    }
}
