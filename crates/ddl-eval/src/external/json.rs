//! A JSON object of a line, and the place of an error in it.

use std::borrow::Cow;

use ddl_core::PedestrianName;
use ddl_data::{Fault, quoted};
use serde::{Deserialize, Deserializer, de::DeserializeOwned};
use serde_json::{Number, Value};
use serde_path_to_error::{Path, Segment};

use crate::external::lines::{self, missing, not_finite};

/// Words for numbers that are not valid JSON, but that several programs write.
const NO_NUMBERS: [&str; 3] = ["NaN", "-Infinity", "Infinity"];

/// A whole number in any notation.
#[derive(Debug, Clone, Copy, Deserialize)]
#[serde(try_from = "Number")]
pub(super) struct Whole(pub(super) i64);

impl TryFrom<Number> for Whole {
    type Error = &'static str;

    fn try_from(number: Number) -> Result<Self, Self::Error> {
        let whole = number.as_i64().or_else(|| lines::whole_number(number.as_f64()?));
        whole.map(Self).ok_or("no whole number")
    }
}

#[derive(Deserialize)]
#[serde(untagged)]
enum Name {
    Number(Whole),
    Word(String),
}

pub(super) fn whole_number<'de, D: Deserializer<'de>>(field: D) -> Result<i64, D::Error> {
    Whole::deserialize(field).map(|Whole(number)| number)
}

/// Deserialises a pedestrian: a whole number in any notation, or a word in quotes.
pub(super) fn pedestrian<'de, D: Deserializer<'de>>(field: D) -> Result<PedestrianName, D::Error> {
    Ok(match Name::deserialize(field)? {
        Name::Number(Whole(number)) => PedestrianName::Number(number),
        Name::Word(word) => PedestrianName::Word(word),
    })
}

/// The object of a line; fields of other names are ignored.
pub(super) fn read<T: DeserializeOwned>(text: &str) -> Result<T, Fault> {
    // The fast parser does not report names of fields, so a line with an error is read again.
    serde_json::from_str(text).or_else(|_| read_with_path(&without_no_numbers(text)))
}

fn read_with_path<T: DeserializeOwned>(text: &str) -> Result<T, Fault> {
    let json = |detail: String| Fault::from(format!("not a JSON object: {detail}"));
    let value: Value = serde_json::from_str(text).map_err(|error| json(error.to_string()))?;
    if !value.is_object() {
        return Err(json(format!("found {}", quoted(&value.to_string()))));
    }
    let mut reader = serde_json::Deserializer::from_str(text);
    serde_path_to_error::deserialize(&mut reader).map_err(|error| {
        let message = error.inner().to_string();
        let field = |name: &str| match error.path().to_string().as_str() {
            "." => name.to_owned(),
            path => format!("{path}.{name}"),
        };
        match message.split('`').collect::<Vec<_>>()[..] {
            ["missing field ", name, ..] => missing(field(name)),
            ["duplicate field ", name, ..] => Fault::named(field(name), "appears twice; keep one"),
            _ => match problem(&value, error.path()) {
                Some(problem) => Fault::named(error.path().to_string(), problem),
                None => json(message),
            },
        }
    })
}

fn problem(value: &Value, path: &Path) -> Option<String> {
    let (mut wrong_value, mut name, mut depth) = (value, "", 0);
    for segment in path {
        match segment {
            Segment::Map { key } => (wrong_value, name, depth) = (wrong_value.get(key)?, key, 0),
            Segment::Seq { index } => (wrong_value, depth) = (wrong_value.get(index)?, depth + 1),
            _ => return None,
        }
    }
    let expected = match (name, depth) {
        ("observed_until", 0) | ("frames", 1) => "a whole number",
        ("pedestrian", 0) => "a whole number or a word",
        ("recording", 0) => "a name in quotes",
        ("frames" | "hypotheses" | "positions", 0) => "a list",
        ("hypotheses", 1) => "an object",
        ("positions", 1) | ("goal", 0) => "[x, y] in metres",
        _ => {
            let found = match wrong_value {
                Value::Null => "null, NaN or infinity".to_owned(),
                wrong_value => quoted(&wrong_value.to_string()),
            };
            return Some(not_finite(&found));
        }
    };
    let found = quoted(&wrong_value.to_string());
    Some(format!("must be {expected}, found {found}"))
}

/// The text with `null` for every word such as NaN outside quotes, so that the error can name its field.
fn without_no_numbers(text: &str) -> Cow<'_, str> {
    let mut replaced = String::new();
    let (mut quoted, mut escaped, mut done) = (false, false, 0);
    let mut index = 0;
    while index < text.len() {
        let byte = text.as_bytes()[index];
        if quoted {
            quoted = byte != b'"' || escaped;
            escaped = byte == b'\\' && !escaped;
        } else if byte == b'"' {
            quoted = true;
        } else if let Some(word) = NO_NUMBERS.iter().find(|word| text.as_bytes()[index..].starts_with(word.as_bytes()))
        {
            replaced += &text[done..index];
            replaced += "null";
            index += word.len();
            done = index;
            continue;
        }
        index += 1;
    }
    if done == 0 {
        return Cow::Borrowed(text);
    }
    replaced += &text[done..];
    Cow::Owned(replaced)
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
