//! How far a model is trusted, and on which motions.

pub(crate) mod calibration;
pub(crate) mod familiarity;
