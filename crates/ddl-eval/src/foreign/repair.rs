//! Fields of a JSON object one by one, each with its path: slower than reading a line as a whole, and done where that
//! failed, to name the field.

use std::borrow::Cow;

use ddl_data::{PedestrianName, Position};
use serde_json::{Map, Value};

use super::unique;

use super::error::ForeignProblem;
use super::lines::{Wrong, in_field, whole_line};

/// Longest piece of a file that an error message quotes, in characters.
const QUOTED: usize = 40;
/// Whole numbers are below this in size: exact in an `f64`.
const LIMIT: f64 = 9_007_199_254_740_992.0;
/// Words for numbers that JSON does not have and several programs write all the same.
const NO_NUMBERS: [&str; 3] = ["NaN", "-Infinity", "Infinity"];

/// The object of a line, each of the `known` fields there once. `NaN` and the infinities are read as `null`, so that
/// their field can be named.
pub(super) fn object(text: &str, known: &[&str]) -> Result<Map<String, Value>, Wrong> {
    match unique::value(&without_no_numbers(text), known)? {
        Value::Object(object) => Ok(object),
        other => {
            let detail = format!("found {}", quoted(&other.to_string()));
            Err(whole_line(ForeignProblem::Json { detail }))
        }
    }
}

/// The text with `null` for every word outside quotes that stands for no number.
fn without_no_numbers(text: &str) -> Cow<'_, str> {
    let mut replaced = String::new();
    let (mut quoted, mut escaped, mut done) = (false, false, 0);
    let mut at = 0;
    while at < text.len() {
        let byte = text.as_bytes()[at];
        if quoted {
            quoted = byte != b'"' || escaped;
            escaped = byte == b'\\' && !escaped;
        } else if byte == b'"' {
            quoted = true;
        } else if let Some(word) = NO_NUMBERS
            .iter()
            .find(|word| text.as_bytes()[at..].starts_with(word.as_bytes()))
        {
            replaced += &text[done..at];
            replaced += "null";
            at += word.len();
            done = at;
            continue;
        }
        at += 1;
    }
    if done == 0 {
        return Cow::Borrowed(text);
    }
    replaced += &text[done..];
    Cow::Owned(replaced)
}

/// A field that may be absent or null.
pub(super) fn optional<'a>(object: &'a Map<String, Value>, key: &str) -> Option<&'a Value> {
    object.get(key).filter(|value| !value.is_null())
}

/// A field that must be there.
pub(super) fn required<'a>(
    object: &'a Map<String, Value>,
    key: &str,
    path: &str,
) -> Result<&'a Value, Wrong> {
    object
        .get(key)
        .ok_or_else(|| in_field(path, ForeignProblem::Missing))
}

/// A whole number, however it is written.
pub(super) fn whole(value: &Value, path: &str) -> Result<i64, Wrong> {
    let number = value.as_i64().or_else(|| {
        let number = value.as_f64()?;
        (number.fract() == 0.0 && number.abs() < LIMIT).then_some(number as i64)
    });
    number.ok_or_else(|| in_field(path, kind("a whole number", value)))
}

/// A pedestrian: a whole number, however it is written, or a word in quotes.
pub(super) fn pedestrian(value: &Value, path: &str) -> Result<PedestrianName, Wrong> {
    match value {
        Value::String(word) if !word.is_empty() => Ok(PedestrianName::Word(word.clone())),
        value if value.is_number() => whole(value, path).map(PedestrianName::Number),
        _ => Err(in_field(path, kind("a whole number or a word", value))),
    }
}

/// A finite number.
pub(super) fn finite(value: &Value, path: &str) -> Result<f64, Wrong> {
    value.as_f64().filter(|n| n.is_finite()).ok_or_else(|| {
        let found = match value {
            Value::Null => "null, NaN or infinity".to_owned(),
            value => quoted(&value.to_string()),
        };
        in_field(path, ForeignProblem::NotFinite { found })
    })
}

/// A list.
pub(super) fn list<'a>(value: &'a Value, path: &str) -> Result<&'a [Value], Wrong> {
    let list = value.as_array().map(Vec::as_slice);
    list.ok_or_else(|| in_field(path, kind("a list", value)))
}

/// `[x, y]`.
pub(super) fn position(value: &Value, path: &str) -> Result<Position, Wrong> {
    match list(value, path)? {
        [x, y] => Ok([
            finite(x, &format!("{path}[0]"))?,
            finite(y, &format!("{path}[1]"))?,
        ]),
        _ => Err(in_field(path, kind("[x, y] in metres", value))),
    }
}

/// That a value is of another kind.
pub(super) fn kind(expected: &'static str, value: &Value) -> ForeignProblem {
    ForeignProblem::Kind {
        expected,
        found: quoted(&value.to_string()),
    }
}

pub(super) fn quoted(text: &str) -> String {
    match text.char_indices().nth(QUOTED) {
        Some((end, _)) => format!("{}...", &text[..end]),
        None => text.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_for_no_number_are_null_outside_quotes_alone() {
        for (text, expected) in [
            ("[1, NaN]", "[1, null]"),
            ("[-Infinity,Infinity,NaN]", "[null,null,null]"),
            (r#"{"NaN\"NaN": NaN}"#, r#"{"NaN\"NaN": null}"#),
            (r#"["a\\", NaN, "ä NaN"]"#, r#"["a\\", null, "ä NaN"]"#),
            ("{}", "{}"),
        ] {
            assert_eq!(without_no_numbers(text), expected);
        }
    }
}
