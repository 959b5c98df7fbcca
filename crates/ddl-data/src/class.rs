//! Classes of tracked objects by the words of their names: people on foot, and others.

/// Classes that are not people on foot. A row of one of them is left out.
const VEHICLES: &str = "car cars veh vehicle truck trucks bus van trailer tram train bicycle bicyclist cyclist biker \
                        bike motorcycle motorcyclist motorbike scooter skater cart vehicles wheeler robot ego";
pub(crate) const PEOPLE: &str = "pedestrian pedestrians ped peds person persons people human";
/// First words of classes that deny people, as in `NonPedestrian`.
const DENIALS: &str = "non not";

/// Whether a class names something else than people on foot, as `car` and `vehicle.bicycle` do.
pub fn is_vehicle(class: &str) -> bool {
    let words = name_words(class);
    let is_other = has_word_of(VEHICLES, &words) && !has_word_of(PEOPLE, &words);
    let is_denied = words.first().is_some_and(|word| is_one_of(DENIALS, word))
        && words.last().is_some_and(|word| is_one_of(PEOPLE, word));
    is_other || is_denied || is_one_of(VEHICLES, &class.to_ascii_lowercase())
}

pub(crate) fn has_word_of(names: &str, words: &[String]) -> bool {
    words.iter().any(|word| is_one_of(names, word))
}

/// Whether a word is one of these, separated by blanks.
pub(crate) fn is_one_of(words: &str, word: &str) -> bool {
    words.split(' ').any(|one| one == word)
}

/// The words of a name in small letters: `trackId`, `track_id` and `Track ID` have the words track and id.
pub(crate) fn name_words(name: &str) -> Vec<String> {
    let mut words = vec![String::new()];
    let mut was_small = false;
    for letter in name.chars() {
        let begins = letter.is_uppercase() && was_small;
        if (begins || !letter.is_alphanumeric()) && words.last().is_some_and(|word| !word.is_empty()) {
            words.push(String::new());
        }
        if letter.is_alphanumeric()
            && let Some(word) = words.last_mut()
        {
            word.extend(letter.to_lowercase());
        }
        was_small = letter.is_lowercase();
    }
    words.retain(|word| !word.is_empty());
    words
}
