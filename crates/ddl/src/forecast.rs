//! From goals to forecasts: the paths that the network shapes, and their certificates.

pub(crate) mod answer;
pub(crate) mod certified;
pub(crate) mod explanations;
pub(crate) mod joint;
pub(crate) mod name;
pub(crate) mod request;
pub(crate) mod shaped;
pub(crate) mod walk;
