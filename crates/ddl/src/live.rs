//! Live streams: tracks frame by frame, one scene or many, with the memory of each place.

pub(crate) mod forecaster;
pub(crate) mod memory_file;
pub(crate) mod place_memory;
#[cfg(feature = "report")]
pub(crate) mod recording_player;
pub(crate) mod scenes;
pub(crate) mod watch;
