//! A vector as it is written to a file: the list of its components.

use nalgebra::SVector;
use serde::{Deserialize, Deserializer, Serialize, Serializer, de::Error};

use crate::real::Real;

pub(super) fn serialize<T, S, const D: usize>(
    vector: &SVector<T, D>,
    serializer: S,
) -> Result<S::Ok, S::Error>
where
    T: Real + Serialize,
    S: Serializer,
{
    vector.as_slice().serialize(serializer)
}

pub(super) fn deserialize<'de, T, S, const D: usize>(
    deserializer: S,
) -> Result<SVector<T, D>, S::Error>
where
    T: Real + Deserialize<'de>,
    S: Deserializer<'de>,
{
    let components = Vec::<T>::deserialize(deserializer)?;
    if components.len() == D {
        Ok(SVector::from_column_slice(&components))
    } else {
        let expected = format!("a list of {D} components");
        Err(S::Error::invalid_length(
            components.len(),
            &expected.as_str(),
        ))
    }
}
