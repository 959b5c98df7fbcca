//! Pictures as SVG, which need neither a display nor a font file.
//!
//! - One scene ([`scene()`]): what was observed (dark dots), what then happened (a solid line to a full
//!   dot), the hypotheses (the likelier the clearer; the representative one dashed, a star at its end), their goals (rings).
//! - Estimated goals ([`goals()`], [`GoalCase`]): a pedestrian a panel, with goals (rings, the likelier the larger; the
//!   nearest bold) and how the similar pedestrians went on (pale lines), chosen by [`typical_pedestrians`].
//!
//! Metres on both axes, at one scale. Colours are those of the [page](crate::page); roles differ in shape too.

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
