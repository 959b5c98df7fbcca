//! The figures of the page: within it they follow its light or dark theme, as files they stand alone on white.
//!
//! They are written with the crate `svg`: theming needs classes on elements, and dashes, stars and rings by class, which
//! plotters' backend, for which every element has its own colours, does not give.

mod case;
mod chart_scale;
mod drawing;
mod headline;
mod marks;
mod training;

pub(super) use case::case_figure;
pub(super) use drawing::{Drawing, STYLE};
pub(super) use headline::{MOST_LINES, Shape, headline_chart};
pub(super) use training::{TrainingPanel, training_panels};
