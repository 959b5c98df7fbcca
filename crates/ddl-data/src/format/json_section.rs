//! A part of a JSON line that should be an object.

use std::fmt;
use std::marker::PhantomData;

use serde::de::value::{MapAccessDeserializer, SeqAccessDeserializer};
use serde::de::{Deserialize, Deserializer, MapAccess, SeqAccess, Visitor};
use serde_json::Value;

use super::field::quoted;

/// The object, or what stands in its place. Errors within the object are those of its own fields.
pub(super) enum Section<T> {
    /// The object.
    Fields(T),
    /// Something else, shortened.
    Other(String),
}

impl<'de, T: Deserialize<'de>> Deserialize<'de> for Section<T> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(Either(PhantomData))
    }
}

struct Either<T>(PhantomData<T>);

fn other<T>(value: &Value) -> Section<T> {
    Section::Other(quoted(&value.to_string()))
}

impl<'de, T: Deserialize<'de>> Visitor<'de> for Either<T> {
    type Value = Section<T>;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a JSON object")
    }

    fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<Section<T>, A::Error> {
        T::deserialize(MapAccessDeserializer::new(map)).map(Section::Fields)
    }

    fn visit_seq<A: SeqAccess<'de>>(self, list: A) -> Result<Section<T>, A::Error> {
        Value::deserialize(SeqAccessDeserializer::new(list)).map(|value| other(&value))
    }

    fn visit_bool<E>(self, value: bool) -> Result<Section<T>, E> {
        Ok(other(&value.into()))
    }

    fn visit_i64<E>(self, value: i64) -> Result<Section<T>, E> {
        Ok(other(&value.into()))
    }

    fn visit_u64<E>(self, value: u64) -> Result<Section<T>, E> {
        Ok(other(&value.into()))
    }

    fn visit_f64<E>(self, value: f64) -> Result<Section<T>, E> {
        Ok(other(&value.into()))
    }

    fn visit_str<E>(self, value: &str) -> Result<Section<T>, E> {
        Ok(other(&value.into()))
    }
}
