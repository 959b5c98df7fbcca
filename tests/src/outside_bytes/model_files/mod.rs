//! The files of a model: a run's `config.json`, `metrics.jsonl` and safetensors files, and the packed model.

pub mod experts;
pub mod json;
mod packed_file;
pub mod packed_model;
mod smallest;
mod sound;
#[cfg(feature = "torch")]
pub mod training_state;
pub mod weights;

use std::path::Path;

fn with_file<T>(path: &Path, bytes: &[u8], read: impl FnOnce(&Path) -> T) -> T {
    std::fs::write(path, bytes).expect("the file can be written");
    read(path)
}

fn names_file(error: &impl std::fmt::Display, name: &str) {
    assert!(error.to_string().contains(name), "{error}");
}
