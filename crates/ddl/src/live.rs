//! Live streams: tracks frame by frame, one scene or many, with the memory of each place.

pub(crate) mod memory_files;
#[cfg(feature = "report")]
pub(crate) mod recording_player;
pub(crate) mod session;
pub(crate) mod waiting;
pub(crate) mod watched_scene;
