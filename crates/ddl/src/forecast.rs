//! From goals to forecasts: the paths that the network shapes, and their certificates.

pub(crate) mod certified;
pub(crate) mod clearance;
pub(crate) mod live;
pub(crate) mod memory_file;
pub(crate) mod name;
pub(crate) mod place_memory;
pub(crate) mod recording_player;
pub(crate) mod scenes;
pub(crate) mod shaped;
pub(crate) mod walk;
pub(crate) mod watch;
