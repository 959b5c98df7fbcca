//! The directory of a run and its files, the recipe of a run, and the sources of models.

pub(crate) mod builtin_model;
pub(crate) mod config;
pub(crate) mod directory;
pub(crate) mod enough_weights;
#[cfg(feature = "files")]
pub(crate) mod few_recordings;
#[cfg(feature = "files")]
pub(crate) mod folds;
pub(crate) mod goal_recipe;
pub(crate) mod lock;
pub(crate) mod model_source;
pub(crate) mod starting_model;
pub(crate) mod track_units;
pub(crate) mod training_data;
#[cfg(feature = "files")]
pub(crate) mod validation_part;
pub(crate) mod words;
