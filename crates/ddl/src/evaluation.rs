//! Evaluation of a model: scores, beside those of baselines and other models.

pub(crate) mod comparison;
pub(crate) mod evaluate;
pub(crate) mod goals;
pub(crate) mod parts;
mod published;
pub(crate) mod record;
pub(crate) mod results;
pub(crate) mod rows;
pub(crate) mod straight_lines;
pub(crate) mod variant;
