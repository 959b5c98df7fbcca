//! How files and streams name pedestrians: by numbers, or by words such as UUIDs.

use std::collections::{BTreeMap, HashMap, VecDeque};
use std::fmt;
use std::sync::Arc;

use serde::{Deserialize, Serialize};

use crate::PedestrianId;
use crate::track::FRAME_LIMIT;

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
pub(crate) fn is_plain(number: &str) -> bool {
    let digits = number.strip_prefix('-').unwrap_or(number);
    digits.bytes().all(|byte| byte.is_ascii_digit()) && (number == "0" || !digits.starts_with('0'))
}

/// The words that a recording or window uses for its pedestrians; empty where the file uses numbers.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct PedestrianNames(Option<Arc<BTreeMap<PedestrianId, Arc<str>>>>);

impl PedestrianNames {
    pub(crate) fn new(words: BTreeMap<PedestrianId, Arc<str>>) -> Self {
        Self((!words.is_empty()).then(|| Arc::new(words)))
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

/// Assigns numbers to words in order of arrival, from 2^53 on: above all numbers that files may use.
#[derive(Debug)]
pub(crate) struct Numbering {
    numbers: HashMap<Arc<str>, i64>,
    words: VecDeque<Arc<str>>,
    forgotten: i64,
    most: usize,
}

impl Numbering {
    /// Remembers at most `most` words; a forgotten word gets a new number.
    pub(crate) fn remembering(most: usize) -> Self {
        Self {
            numbers: HashMap::new(),
            words: VecDeque::new(),
            forgotten: 0,
            most,
        }
    }

    /// The number of a word, and the shared copy of the word.
    pub(crate) fn number(&mut self, word: &str) -> (PedestrianId, Arc<str>) {
        if let Some((word, &number)) = self.numbers.get_key_value(word) {
            return (PedestrianId(number), Arc::clone(word));
        }
        if self.words.len() == self.most
            && let Some(oldest) = self.words.pop_front()
        {
            self.numbers.remove(&oldest);
            self.forgotten += 1;
        }
        let number = FRAME_LIMIT + self.forgotten + self.words.len() as i64;
        let word: Arc<str> = word.into();
        self.numbers.insert(Arc::clone(&word), number);
        self.words.push_back(Arc::clone(&word));
        (PedestrianId(number), word)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn the_last_words_keep_their_numbers(words in prop::collection::vec("[a-d]{1,3}", 0..200)) {
            let mut numbering = Numbering::remembering(5);
            let mut last = FRAME_LIMIT - 1;
            for word in &words {
                let known = numbering.numbers.get(word.as_str()).copied();
                let (PedestrianId(number), kept) = numbering.number(word);
                prop_assert_eq!(&*kept, word.as_str());
                last += i64::from(known.is_none());
                prop_assert_eq!(number, known.unwrap_or(last));
                prop_assert!(numbering.words.len() <= 5 && numbering.numbers.len() <= 5);
            }
        }

        #[test]
        fn numbers_and_words_come_back_as_they_were_written(text in "[-+0-9a-c.]{1,5}") {
            prop_assert_eq!(PedestrianName::of_text(&text).to_string(), text);
        }
    }
}
