#![doc = include_str!("../README.md")]

mod decode;
mod error;
mod files;
mod messages;
mod tracks;
mod write;

pub use error::{LogError, LogProblem};
pub use files::{is_log, is_mcap};
pub use tracks::{LoggedTracks, TrackTopic, read_log};
pub use write::ForecastLog;
