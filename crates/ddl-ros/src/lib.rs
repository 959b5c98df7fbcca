#![doc = include_str!("../README.md")]

mod cdr;
mod definitions;
mod error;
mod forecasts;
pub mod msg;
mod tracks;

pub use cdr::{Message, read, write};
pub use definitions::definition;
pub use error::RosError;
pub use forecasts::{ForecastMessages, occupancy_grid};
pub use tracks::{Observed, SeenPedestrian, Tracks, read_tracks};
