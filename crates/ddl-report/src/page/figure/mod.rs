//! The figures of the page: within it they follow its light or dark theme, as files they stand alone on white.

mod case;
mod headline;
mod training;

pub(super) use case::case_figure;
pub(super) use headline::{MOST_LINES, Shape, headline_chart};
pub(super) use training::{TrainingPanel, training_panels};
