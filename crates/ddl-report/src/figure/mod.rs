//! Pictures as SVG, which need neither a display nor a font file.
//! One scene ([`scene()`]), or estimated goals, a pedestrian a panel ([`goals()`], [`GoalCase`]), chosen by
//! [`typical_pedestrians`]: metres on both axes, at one scale. Colours are those of the [page](crate::page).

mod axes;
pub(crate) mod drawing;
mod error;
mod goal_case;
mod goals;
mod legend;
pub(crate) mod marks;
pub(crate) mod pedestrian;
pub(crate) mod plan;
pub(crate) mod scale;
mod scene;
mod typical;
mod wrap;

pub use error::FigureError;
pub use goal_case::GoalCase;
pub use goals::goals;
pub use scene::scene;
pub use typical::typical_pedestrians;
