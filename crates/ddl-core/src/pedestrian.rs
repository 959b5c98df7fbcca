//! Pedestrians: their numbers, and how files and streams name them, by numbers or by words such as UUIDs.

use std::collections::BTreeMap;
use std::fmt;
use std::sync::Arc;

use serde::{Deserialize, Serialize};

use crate::position::is_frame;

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
    /// Interprets a text, in files and streams alike: a number where programs print it so, as `12`, or with a decimal
    /// point, as `12.0` and `1.2e1`; else a word, as `007`, `1e3`, `+5` and numbers from 2^53 on.
    #[must_use]
    pub fn of_text(text: &str) -> Self {
        let of_float = || {
            let number = text.parse::<f64>().ok().filter(|number| number.fract() == 0.0 && text.contains('.'))?;
            // Within the limit of frames every whole `f64` is exactly an `i64`.
            Some(number as i64)
        };
        let number = text.parse::<i64>().ok().or_else(of_float).filter(|number| is_plain(text) && is_frame(*number));
        number.map_or_else(|| Self::Word(text.to_owned()), Self::Number)
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

/// Whether a number is written as it is printed, without `+`, `-0` or leading zeros.
fn is_plain(number: &str) -> bool {
    let (digits, is_negative) = number.strip_prefix('-').map_or((number, false), |digits| (digits, true));
    let is_zero = digits == "0" && !is_negative;
    is_zero || digits.starts_with("0.") || digits.starts_with(|first| matches!(first, '1'..='9'))
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

    /// Whether a pedestrian has this name; JSON may quote a number.
    pub(crate) fn names(&self, id: PedestrianId, name: &PedestrianName) -> bool {
        match (self.word(id), name) {
            (None, PedestrianName::Number(number)) => id.0 == *number,
            (Some(word), PedestrianName::Word(name)) => word == name,
            (Some(word), PedestrianName::Number(number)) => word == number.to_string(),
            (None, PedestrianName::Word(name)) => PedestrianName::of_text(name) == id.into(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn names_come_back_as_they_were_written(text in "[-+ 0-9a-ce]{1,5}", number: i64) {
            prop_assert_eq!(PedestrianName::of_text(&text).to_string(), text);
            let read = PedestrianName::of_text(&number.to_string());
            prop_assert_eq!(matches!(read, PedestrianName::Number(read) if read == number), is_frame(number));
        }

        #[test]
        fn floats_are_the_numbers_that_they_print(number in -100_000_000..100_000_000_i64) {
            let float = number as f64;
            for text in [format!("{float:.1}"), format!("{float:.18}"), format!("{float:.8e}")] {
                prop_assert_eq!(PedestrianName::of_text(&text), PedestrianName::Number(number), "{}", text);
            }
        }
    }
}
