//! `ddl forecast`: forecasts of a file of tracks or of live tracks.

mod arguments;
mod first_rows;
mod frames;
mod kept_memory;
mod left_out;
mod live;
mod moment;
mod stream;
mod table;
mod told_once;

pub(crate) use arguments::ForecastCommand;
pub(crate) use kept_memory::file_stem;
pub(crate) use moment::StreamState;
pub(crate) use stream::{Answer, OutputFormat, StreamOptions, answer};
