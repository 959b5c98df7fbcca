//! Pictures as SVG, which need neither a display nor a font file.
//! One scene ([`scene()`]), where the tracks of a place lead ([`place()`]), or estimated goals, a pedestrian a panel
//! ([`goals()`], [`GoalCase`]), chosen by [`typical_pedestrians`]: metres on both axes, at one scale; or shares over time
//! ([`coverage()`]). Colours are those of the [page](crate::page).

mod axes;
mod coverage;
pub(crate) mod drawing;
mod error;
mod goal_case;
mod goals;
mod legend;
pub(crate) mod marks;
pub(crate) mod over_time;
pub(crate) mod pedestrian;
mod place;
pub(crate) mod plan;
pub(crate) mod scale;
mod scene;
mod traffic;
mod typical;
mod wrap;

pub use coverage::{CoveragePanel, coverage};
pub use error::FigureError;
pub use goal_case::GoalCase;
pub use goals::goals;
pub use place::place;
pub use scene::scene;
pub use typical::typical_pedestrians;
