//! Pictures as SVG, which need neither a display nor a font file.
//!
//! - One scene ([`scene`], [`SceneFigure`]): what was observed (dark dots), what then happened (solid blue,
//!   a full dot at the end), the hypotheses (orange, the more likely the more opaque; the representative
//!   one dashed and bold, a star at its end) and their goals (green rings).
//! - Estimated goals ([`goals`], [`GoalCase`]): a walker in each panel, with the goals (green rings, the
//!   more likely the larger; the one nearest the true end bold) and how the similar walkers went on whom
//!   they come from (pale lines). [`typical_walkers`] picks walkers worth showing.
//!
//! Metres on both axes, at one scale. The colours are those of Okabe and Ito, told apart by colour-blind
//! readers; roles differ in shape as well as in colour.

mod axes;
mod canvas;
mod clip;
pub(crate) mod error;
mod goal_case;
mod goal_figure;
mod goal_ring;
mod layout;
mod legend;
mod scene_figure;
mod typical;
mod walker;
mod wrap;

pub use goal_case::GoalCase;
pub use goal_figure::goals;
pub use scene_figure::{SceneFigure, scene};
pub use typical::typical_walkers;
