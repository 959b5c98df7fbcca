//! Pieces of texts of others, for messages.

/// Longest piece of a file that an error message quotes, in characters.
const QUOTED: usize = 40;

/// A piece of a text of others for a message: 40 characters at most, without control characters.
pub fn quoted(text: &str) -> String {
    let (text, rest) = match text.char_indices().nth(QUOTED) {
        Some((end, _)) => (&text[..end], "..."),
        None => (text, ""),
    };
    escaped(text) + rest
}

/// A text of others with its control characters, which would act on terminals, as escapes.
pub fn escaped(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for letter in text.chars() {
        if letter.is_control() {
            escaped.extend(letter.escape_default());
        } else {
            escaped.push(letter);
        }
    }
    escaped
}
