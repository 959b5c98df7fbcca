#![doc = include_str!("../README.md")]

mod augment;
mod convention;
mod dataset;
mod error;
mod fold;
pub mod format;
mod live;
mod locate;
mod neighbours;
mod recording;
mod rule;
pub mod simulate;
mod track;
mod window;

pub use augment::Rotation;
pub use convention::Convention;
pub use dataset::Dataset;
pub use error::{DataError, FormatError, FormatProblem, RecordingError, UnknownName, WindowError};
pub use fold::{Fold, SocialGanSplit, TrainingSplit};
pub use format::{Format, parse_recording, read_recording};
pub use live::{LiveError, LiveTracks};
pub use locate::{DATASETS_VARIABLE, locate};
pub use neighbours::{NEIGHBOUR_HALF_WIDTH, NeighbourMask};
pub use recording::Recording;
pub use rule::WindowRule;
pub use track::{HORIZON, OBSERVED, Observation, PedestrianId, Position, TIME_STEP, WINDOW};
pub use window::Window;
