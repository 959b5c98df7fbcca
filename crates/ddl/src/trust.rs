//! Trust in a model, depending on how familiar a motion is.

pub(crate) mod calibration;
pub(crate) mod familiarity;
pub(crate) mod fingerprints;
