#![doc = include_str!("../README.md")]

mod atomic_file;
mod error;
mod file_lock;
mod forecast;
mod forecaster;
pub mod motion;
mod names;
mod numbering;
mod pace;
mod pedestrian;
mod position;
mod quality;
mod region;
mod region_table;
mod representative;
mod rotation;
mod setting;
mod spatial_index;
mod weighted_goals;
mod window;
mod work_done;

pub use atomic_file::{remove_temporary_files, write_atomically, write_atomically_with};
pub use error::{ForecastError, ForecastShapeError, WindowError};
pub use file_lock::FileLock;
pub use forecast::{Forecast, Spread};
pub use forecaster::Forecaster;
pub use names::UnknownName;
pub use numbering::Numbering;
pub use pace::{Pace, mean_speed};
pub use pedestrian::{PedestrianId, PedestrianName, PedestrianNames};
pub use position::{
    COORDINATE_LIMIT, FRAME_LIMIT, HORIZON, OBSERVED, Position, TIME_STEP, WINDOW, between, bounds, distance,
    is_finite, is_frame, is_frame_step,
};
pub use quality::{ObservationQuality, OtherObservation};
pub use region::{AdaptiveRegions, Holding};
pub use region_table::{Disc, RegionTable};
pub use representative::{average_displacement, medoid};
pub use rotation::Rotation;
pub use setting::{Setting, SettingWords, word_settings};
pub use spatial_index::SpatialIndex;
pub use weighted_goals::WeightedGoals;
pub use window::{RememberedTrack, Window};
pub use work_done::WorkDone;
