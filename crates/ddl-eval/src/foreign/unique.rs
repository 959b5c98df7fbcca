//! JSON values in which no field is named twice: `serde_json` itself keeps the last.

use std::cell::RefCell;
use std::fmt;

use serde::de::{DeserializeSeed, Deserializer, Error, MapAccess, SeqAccess, Visitor};
use serde_json::{Map, Value};

use super::error::ForeignProblem;
use super::lines::{Wrong, in_field, whole_line};

/// Reads a text; one of the `known` fields twice in one object is an error. Other fields are not used, so that it does not
/// matter which of them is kept.
pub(super) fn value(text: &str, known: &[&str]) -> Result<Value, Wrong> {
    let twice = RefCell::new(None);
    let seed = Unique {
        known,
        path: &Path::Root,
        twice: &twice,
    };
    let mut reader = serde_json::Deserializer::from_str(text);
    let read = seed
        .deserialize(&mut reader)
        .and_then(|value| reader.end().map(|()| value));
    read.map_err(|error| match twice.take() {
        Some(path) => in_field(path, ForeignProblem::TwiceNamed),
        None => whole_line(ForeignProblem::Json {
            detail: error.to_string(),
        }),
    })
}

/// Where a value stands; written out for messages alone.
enum Path<'a> {
    Root,
    Field(&'a Path<'a>, &'a str),
    Entry(&'a Path<'a>, usize),
}

impl fmt::Display for Path<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Root => Ok(()),
            Self::Field(Self::Root, name) => f.write_str(name),
            Self::Field(parent, name) => write!(f, "{parent}.{name}"),
            Self::Entry(parent, index) => write!(f, "{parent}[{index}]"),
        }
    }
}

#[derive(Clone, Copy)]
struct Unique<'a> {
    known: &'a [&'a str],
    path: &'a Path<'a>,
    /// The field that is there twice, once it is met.
    twice: &'a RefCell<Option<String>>,
}

impl<'de> DeserializeSeed<'de> for Unique<'_> {
    type Value = Value;

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<Value, D::Error> {
        deserializer.deserialize_any(self)
    }
}

impl<'de> Visitor<'de> for Unique<'_> {
    type Value = Value;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a JSON value")
    }

    fn visit_bool<E>(self, value: bool) -> Result<Value, E> {
        Ok(value.into())
    }

    fn visit_i64<E>(self, value: i64) -> Result<Value, E> {
        Ok(value.into())
    }

    fn visit_u64<E>(self, value: u64) -> Result<Value, E> {
        Ok(value.into())
    }

    fn visit_f64<E>(self, value: f64) -> Result<Value, E> {
        Ok(value.into())
    }

    fn visit_str<E>(self, value: &str) -> Result<Value, E> {
        Ok(value.into())
    }

    fn visit_unit<E>(self) -> Result<Value, E> {
        Ok(Value::Null)
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut entries: A) -> Result<Value, A::Error> {
        let mut list = Vec::new();
        loop {
            let path = &Path::Entry(self.path, list.len());
            match entries.next_element_seed(Unique { path, ..self })? {
                Some(entry) => list.push(entry),
                None => return Ok(Value::Array(list)),
            }
        }
    }

    fn visit_map<A: MapAccess<'de>>(self, mut fields: A) -> Result<Value, A::Error> {
        let mut object = Map::new();
        while let Some(name) = fields.next_key::<String>()? {
            let path = &Path::Field(self.path, &name);
            if self.known.contains(&name.as_str()) && object.contains_key(&name) {
                *self.twice.borrow_mut() = Some(path.to_string());
                return Err(A::Error::custom("a field is there twice"));
            }
            let value = fields.next_value_seed(Unique { path, ..self })?;
            object.insert(name, value);
        }
        Ok(Value::Object(object))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_value_is_read_as_serde_json_reads_it() {
        let text = r#" {"a": [1, -2, 3.5, 1e2, null, true, "x\n"], "b": {"a": {}, "c": []}} "#;
        let expected: Value = serde_json::from_str(text).unwrap();
        assert_eq!(value(text, &["a", "b", "c"]), Ok(expected));
        assert!(value("{} {}", &[]).is_err());
        assert!(value(&"[".repeat(100_000), &[]).is_err());
    }

    #[test]
    fn a_field_that_is_there_twice_is_named_with_its_path() {
        let text = r#"{"other": 1, "other": 2, "list": [{}, {"x": 1, "x": 1}]}"#;
        let twice = in_field("list[1].x", ForeignProblem::TwiceNamed);
        assert_eq!(value(text, &["x"]), Err(twice));
        assert_eq!(value(text, &["list"]).unwrap()["other"], 2);
    }
}
