//! What is remembered of a finished task, so that a second run leaves it out.

use super::plan::Task;
use anyhow::Context as _;
use ddl::data::write_whole;
use serde::{Deserialize, Serialize};
use std::path::Path;

/// In the task's folder; written when both training and scoring have succeeded.
const FILE: &str = "finished.json";

#[derive(Debug, Serialize, Deserialize)]
struct Record {
    task: String,
    seconds: f64,
}

/// Whether the task was finished and its scores are still there.
pub(super) fn is_finished(task: &Task, out: &Path) -> bool {
    let record = std::fs::read(task.folder(out).join(FILE))
        .ok()
        .and_then(|text| serde_json::from_slice::<Record>(&text).ok());
    record.is_some_and(|record| record.task == task.id)
        && task.run_folder(out).join("report.json").is_file()
}

pub(super) fn write(task: &Task, out: &Path, seconds: f64) -> anyhow::Result<()> {
    let file = task.folder(out).join(FILE);
    let record = Record {
        task: task.id.clone(),
        seconds,
    };
    let text = serde_json::to_vec(&record)?;
    write_whole(&file, &text).with_context(|| format!("cannot write {}", file.display()))
}
