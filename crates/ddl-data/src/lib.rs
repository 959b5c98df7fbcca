#![doc = include_str!("../README.md")]

mod augment;
mod completion;
mod convention;
mod dataset;
mod doubt;
mod error;
mod fold;
pub mod format;
mod homography;
mod live;
mod locate;
mod names;
mod neighbours;
mod rate;
mod recording;
mod remembered;
mod rule;
mod scene_name;
pub mod simulate;
mod summary;
mod track;
mod unknown_name;
mod whole_file;
mod window;

pub use augment::Rotation;
pub use completion::{Completion, CompletionError, MadeUp};
pub use convention::Convention;
pub use dataset::Dataset;
pub use doubt::{Doubt, Fastest};
pub use error::{DataError, FormatError, RecordingError, WindowError};
pub use fold::{Fold, SocialGanSplit, TrainingSplit};
pub use format::{Format, Frame, FrameReader, parse_recording, read_recording, write_recording};
pub use homography::{Homography, HomographyError};
pub use live::{LiveError, LiveTracks, checked_frame, checked_frame_step};
pub use locate::{DATASETS_VARIABLE, locate};
pub use names::{PedestrianName, PedestrianNames};
pub use neighbours::{NEIGHBOUR_HALF_WIDTH, Neighbours, Places};
pub use rate::{InSteps, RateError, whole_frame_step};
pub use recording::Recording;
pub use remembered::Remembered;
pub use rule::WindowRule;
pub use scene_name::{SceneName, SceneNameError};
pub use summary::{Hole, Summary};
pub use track::{
    COORDINATE_LIMIT, HORIZON, OBSERVED, Observation, PedestrianId, Position, TIME_STEP, WINDOW,
};
pub use unknown_name::UnknownName;
pub use whole_file::{remove_half_written, write_whole};
pub use window::Window;
