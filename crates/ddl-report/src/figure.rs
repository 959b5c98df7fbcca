//! Figures as SVG, which need neither a display nor a font file.
//!
//! - [`scene()`]: one scene with its forecasts;
//! - [`place()`]: the tracks of a place;
//! - [`goals()`]: estimated goals, one panel for each pedestrian ([`GoalCase`]).
//!
//! Maps show metres at one scale for both axes. Colours are those of the [page](crate::page).

mod axes;
pub(crate) mod drawing;
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
mod wrap;

pub use goal_case::GoalCase;
pub use goals::goals;
pub use place::place;
pub use scene::scene;
