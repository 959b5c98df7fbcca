//! `ddl forecast`: forecasts of a file of tracks or of live tracks.

mod answer;
mod arguments;
mod first_rows;
mod frames;
mod left_out;
mod live;
mod plans;
mod state;
mod stream;

pub(crate) use answer::answer;
pub(crate) use arguments::ForecastCommand;
pub(crate) use plans::{NamedPlan, PlanFile};
pub(crate) use state::StreamState;
pub(crate) use stream::{AnsweringCommand, OutputFormat, StreamOptions};
