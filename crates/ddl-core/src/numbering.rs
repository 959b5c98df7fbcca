//! Numbers for pedestrians that a file or stream names by words.

use std::collections::{BTreeMap, HashMap};
use std::sync::Arc;

use crate::pedestrian::PedestrianId;
use crate::position::FRAME_LIMIT;

/// Assigns numbers to words in order of arrival, from 2^53 on: above all numbers that files may use.
#[derive(Debug)]
pub struct Numbering {
    /// The number of each word, and when it was last used.
    numbers: HashMap<Arc<str>, (i64, u64)>,
    by_use: BTreeMap<u64, Arc<str>>,
    uses: u64,
    next: i64,
    most: usize,
}

impl Numbering {
    /// Remembers at most `most` words; the word that was not used for longest is forgotten, and then gets a new number.
    pub fn remembering(most: usize) -> Self {
        Self { numbers: HashMap::new(), by_use: BTreeMap::new(), uses: 0, next: FRAME_LIMIT, most }
    }

    /// The number of a word, and the shared copy of the word.
    pub fn number(&mut self, word: &str) -> (PedestrianId, Arc<str>) {
        self.uses += 1;
        if let Some((number, used)) = self.numbers.get_mut(word) {
            let known = self.by_use.remove(used).unwrap_or_else(|| word.into());
            *used = self.uses;
            self.by_use.insert(self.uses, Arc::clone(&known));
            return (PedestrianId(*number), known);
        }
        if self.numbers.len() == self.most
            && let Some((_, oldest)) = self.by_use.pop_first()
        {
            self.numbers.remove(&oldest);
        }
        let (number, word) = (self.next, Arc::<str>::from(word));
        self.next += 1;
        self.numbers.insert(Arc::clone(&word), (number, self.uses));
        self.by_use.insert(self.uses, Arc::clone(&word));
        (PedestrianId(number), word)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn the_words_used_last_keep_their_numbers(words in prop::collection::vec("[a-d]{1,3}", 0..200)) {
            let mut numbering = Numbering::remembering(5);
            let (mut next, mut used): (i64, Vec<(&str, i64)>) = (FRAME_LIMIT, Vec::new());
            for word in &words {
                let known = used.iter().position(|(known, _)| known == word).map(|place| used.remove(place).1);
                used.push((word, known.unwrap_or(next)));
                next += i64::from(known.is_none());
                used.drain(..used.len().saturating_sub(5));
                let (PedestrianId(number), kept) = numbering.number(word);
                prop_assert_eq!((&*kept, number), *used.last().unwrap());
                prop_assert!(numbering.by_use.len() == used.len() && numbering.numbers.len() == used.len());
            }
        }
    }
}
