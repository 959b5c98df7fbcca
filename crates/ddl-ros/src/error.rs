//! Errors of this crate.

/// A message cannot be read or written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
#[expect(missing_docs, reason = "the messages describe the fields")]
pub enum RosError {
    #[error("a message of {found} bytes has no head: CDR begins with 4 bytes that name its encoding")]
    NoHead { found: usize },
    #[error("the message begins with the encoding {found:#06x}; ROS 2 writes plain CDR, 0x0000 or 0x0001")]
    Encoding { found: u16 },
    #[error("the bytes are not a message {type_name}: {source}; the sender may have another version of it")]
    Cdr { type_name: &'static str, source: cdr_encoding::Error },
    #[error("{left} bytes follow a message {type_name}; the sender may have another version of it")]
    Rest { type_name: &'static str, left: usize },
    #[error("{type_name} is no type of tracks; give {known}")]
    UnknownType { type_name: String, known: String },
    #[error("{type_name}: the header has no time: the tracker must set header.stamp")]
    NoTime { type_name: &'static str },
    #[error("{type_name}: {field}[{index}] has no {id}: the tracker must give each pedestrian one")]
    NoId { type_name: &'static str, field: &'static str, index: usize, id: &'static str },
}
