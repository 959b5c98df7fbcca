//! The goals of a model.

pub(crate) mod experts;
pub(crate) mod first_seen;
pub(crate) mod model;
pub(crate) mod packed;
pub(crate) mod reach;
#[cfg(feature = "files")]
pub(crate) mod remembering;
pub(crate) mod sets;
pub(crate) mod unforeseen;
pub(crate) mod views;
