#![doc = include_str!("../README.md")]

mod error;
mod forecast;
mod forecaster;
pub mod motion;
mod names;
mod pace;
mod pedestrian;
mod position;
mod quality;
mod region;
mod region_table;
mod representative;
mod weighted_goals;
mod window;
mod work_done;

pub use error::{ForecastError, ForecastShapeError, WindowError};
pub use forecast::{Forecast, Spread};
pub use forecaster::Forecaster;
pub use names::UnknownName;
pub use pace::{Pace, mean_speed};
pub use pedestrian::{PedestrianId, PedestrianName, PedestrianNames};
pub use position::{
    FRAME_LIMIT, HORIZON, OBSERVED, Position, TIME_STEP, WINDOW, between, bounds, distance, is_finite, is_frame,
    is_frame_step,
};
pub use quality::ObservationQuality;
pub use region::AdaptiveRegions;
pub use region_table::{Disc, RegionTable};
pub use representative::{average_displacement, medoid};
pub use weighted_goals::WeightedGoals;
pub use window::{RememberedTrack, Window};
pub use work_done::WorkDone;
