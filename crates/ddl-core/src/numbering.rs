//! Numbers for pedestrians that a file or stream names by words.

use std::collections::{HashMap, VecDeque};
use std::sync::Arc;

use crate::pedestrian::PedestrianId;
use crate::position::FRAME_LIMIT;

/// Assigns numbers to words in order of arrival, from 2^53 on: above all numbers that files may use.
#[derive(Debug)]
pub struct Numbering {
    numbers: HashMap<Arc<str>, i64>,
    words: VecDeque<Arc<str>>,
    forgotten: i64,
    most: usize,
}

impl Numbering {
    /// Remembers at most `most` words; a forgotten word gets a new number.
    pub fn remembering(most: usize) -> Self {
        Self { numbers: HashMap::new(), words: VecDeque::new(), forgotten: 0, most }
    }

    /// The number of a word, and the shared copy of the word.
    pub fn number(&mut self, word: &str) -> (PedestrianId, Arc<str>) {
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
                let number_before = numbering.numbers.get(word.as_str()).copied();
                let (PedestrianId(number), kept) = numbering.number(word);
                prop_assert_eq!(&*kept, word.as_str());
                last += i64::from(number_before.is_none());
                prop_assert_eq!(number, number_before.unwrap_or(last));
                prop_assert!(numbering.words.len() <= 5 && numbering.numbers.len() <= 5);
            }
        }
    }
}
