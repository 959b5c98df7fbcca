//! Pictures as SVG, which need neither a display nor a font file.
//!
//! - One scene ([`scene()`], [`SceneFigure`]): what was observed (dark dots), what then happened (a solid line to a full dot), the
//!   hypotheses (the more likely the clearer; the representative one dashed and bold, a star at its end) and their goals (rings).
//! - Estimated goals ([`goals()`], [`GoalCase`]): a pedestrian in each panel, with the goals (rings, the more likely the larger; the
//!   one nearest the true end bold) and how the similar pedestrians went on whom they come from (pale lines). [`typical_pedestrians`]
//!   picks pedestrians worth showing.
//!
//! Metres on both axes, at one scale. Colours are those of the [page](crate::page): blue for what is forecast, orange for what
//! happened, which every kind of colour vision tells apart; roles differ in shape as well as in colour.

mod axes;
pub(crate) mod drawing;
mod error;
mod goal_case;
mod goal_ring;
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
pub use scene::{SceneFigure, scene};
pub use typical::typical_pedestrians;
