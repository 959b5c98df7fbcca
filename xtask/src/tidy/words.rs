//! Words and phrases that no text of the repository may use.

use std::path::Path;

/// Extensions of the checked files.
const READ: [&str; 9] = ["md", "rs", "py", "toml", "html", "js", "css", "ipynb", "cff"];
/// Forbidden phrases and their replacements. Spelled in pieces, so that this file does not find itself.
const PHRASES: [(&str, &str); 15] = [
    (concat!("wal", "ker"), "pedestrian"),
    (concat!("wal", "kers"), "pedestrians"),
    (concat!("walking", " people"), "pedestrians"),
    (concat!("that is", " none"), "say what it is"),
    (concat!("that are", " none"), "say what they are"),
    (concat!("is no", " number"), "is not a number"),
    (concat!("are no", " numbers"), "are not numbers"),
    (concat!("of", " nobody"), "of pedestrians that are not there"),
    (concat!("knows", " nobody"), "say what is not known"),
    (concat!("know", " nobody"), "say what is not known"),
    (concat!("goes on", " as before"), "keeps its velocity"),
    (concat!("go on", " as before"), "keep their velocity"),
    (
        concat!("stands", " sways"),
        "a standing pedestrian moves by a few centimetres",
    ),
    (concat!("by", " heart"), "overfits"),
    (concat!("of the", " house"), "of the workspace"),
];
/// Markers of comments and quotations, which may separate two words of a phrase.
const MARKS: [&str; 7] = ["//", "///", "//!", "#", ">", "*", "|"];

/// The positions at which a text uses one of the phrases.
pub(super) fn faults(file: &Path, text: &str) -> Vec<String> {
    let extension = file.extension().and_then(|extension| extension.to_str());
    if !extension.is_some_and(|extension| READ.contains(&extension)) {
        return Vec::new();
    }
    let words = words(text);
    let phrases = PHRASES.map(|(phrase, instead)| {
        let parts: Vec<&str> = phrase.split(' ').collect();
        (phrase, parts, instead)
    });
    let mut faults = Vec::new();
    for at in 0..words.len() {
        for (phrase, parts, instead) in &phrases {
            let found =
                parts.len() <= words.len() - at && parts.iter().zip(&words[at..]).all(|(part, (_, word))| part == word);
            if found {
                let (line, _) = words[at];
                faults.push(format!("{}:{line}: {phrase:?}: {instead}", file.display()));
            }
        }
    }
    faults
}

/// The words of a text in lower case, each with its line. A name in code is split into its parts.
fn words(text: &str) -> Vec<(usize, String)> {
    let mut words = Vec::new();
    for (number, line) in (1..).zip(text.lines()) {
        for word in line.split_whitespace().filter(|word| !MARKS.contains(word)) {
            let mut part = String::new();
            let mut was_small = false;
            for letter in word.chars() {
                let is_new = letter.is_uppercase() && was_small || !letter.is_alphanumeric();
                if is_new && !part.is_empty() {
                    words.push((number, std::mem::take(&mut part)));
                }
                was_small = letter.is_lowercase();
                if letter.is_alphanumeric() {
                    part.extend(letter.to_lowercase());
                } else if ".;:!?,\"".contains(letter) {
                    // A phrase does not extend over the end of a sentence or of a string.
                    words.push((number, String::new()));
                }
            }
            if !part.is_empty() {
                words.push((number, part));
            }
        }
    }
    words
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_phrase_is_found_in_names_and_across_lines() {
        let [pedestrian, number] = [PHRASES[0].0, PHRASES[5].0];
        let (before, after) = number.split_at(5);
        for (text, line) in [
            (format!("a {pedestrian}."), 1),
            (format!("a\nfn goal_of_a_{pedestrian}() {{}}"), 2),
            (format!("struct My{}er;", "Walk"), 1),
            (format!("/// This {before}\n    ///{after} at all"), 1),
        ] {
            let found = faults(Path::new("a.rs"), &text);
            assert!(
                found.len() == 1 && found[0].starts_with(&format!("a.rs:{line}: ")),
                "{found:?}"
            );
        }
        for text in [format!("It {}. {after}", before.trim()), "A walk is walked.".to_owned()] {
            assert_eq!(faults(Path::new("a.rs"), &text), [] as [&str; 0], "{text}");
        }
        assert!(faults(Path::new("a.svg"), pedestrian).is_empty());
    }
}
