//! Messages as bytes: plain CDR behind a head of 4 bytes, as DDS sends them and recordings store them.

use crate::error::RosError;
use byteorder::{BigEndian, LittleEndian};
use serde::{Serialize, de::DeserializeOwned};

/// Names of the encodings, the first two bytes of a message.
const BIG_ENDIAN: u16 = 0;
const LITTLE_ENDIAN: u16 = 1;
/// Length of the head, and what a message is padded to.
const HEAD: usize = 4;

/// A message that has a [definition](crate::definition).
pub trait Message: Serialize + DeserializeOwned {
    /// Its name in ROS 2, such as `nav_msgs/msg/Path`.
    const TYPE: &'static str;
}

/// Reads a message from its bytes.
///
/// # Errors
/// The bytes are not in plain CDR, end early, or go on after the message.
pub fn read<M: Message>(bytes: &[u8]) -> Result<M, RosError> {
    let Some(([first, second, _, _], body)) = bytes.split_first_chunk::<HEAD>() else {
        return Err(RosError::NoHead { found: bytes.len() });
    };
    let decoded = match u16::from_be_bytes([*first, *second]) {
        BIG_ENDIAN => cdr_encoding::from_bytes::<M, BigEndian>(body),
        LITTLE_ENDIAN => cdr_encoding::from_bytes::<M, LittleEndian>(body),
        found => return Err(RosError::Encoding { found }),
    };
    let type_name = M::TYPE;
    let (message, length) = decoded.map_err(|source| RosError::Cdr { type_name, source })?;
    let left = body.len() - length;
    if left >= HEAD {
        return Err(RosError::Rest { type_name, left });
    }
    Ok(message)
}

/// The bytes of a message, little-endian.
///
/// # Errors
/// None for the messages of this crate.
pub fn write<M: Message>(message: &M) -> Result<Vec<u8>, RosError> {
    let mut bytes = vec![0, LITTLE_ENDIAN as u8, 0, 0];
    let body = cdr_encoding::to_vec::<M, LittleEndian>(message)
        .map_err(|source| RosError::Cdr { type_name: M::TYPE, source })?;
    bytes.extend(body);
    Ok(bytes)
}
