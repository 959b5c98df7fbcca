//! What a finished training leaves behind, as far as it is the same every time.

use crate::folder_contents::{self, Contents};
use std::path::{Path, PathBuf};

/// The files of a run, byte for byte, but for what holds seconds: of `metrics.jsonl` the losses are compared, and
/// `optimizer.safetensors` holds the weights of the model.
pub fn of(run: &Path) -> Contents {
    let mut files = folder_contents::read(run);
    let metrics = files.remove(&PathBuf::from("metrics.jsonl")).flatten();
    let metrics = String::from_utf8(metrics.expect("there are metrics")).expect("JSON is text");
    let epochs: Vec<_> = metrics.lines().map(losses).collect();
    files.insert(PathBuf::from("losses"), Some(epochs.concat().into_bytes()));
    files.remove(&PathBuf::from("optimizer.safetensors"));
    files
}

/// A line of `metrics.jsonl` without its seconds.
fn losses(line: &str) -> String {
    let mut epoch: serde_json::Value = serde_json::from_str(line).expect("a line is JSON");
    let fields = epoch.as_object_mut().expect("a line is an object");
    fields.remove("seconds").expect("an epoch takes seconds");
    epoch.to_string()
}
