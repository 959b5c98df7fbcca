//! The file of a finished task. A second run skips tasks that have one.

use crate::command::benchmark::plan::Task;
use anyhow::Context as _;
use ddl::data::write_atomically;
use serde::{Deserialize, Serialize};
use std::fs;
use std::path::Path;

const FILE: &str = "finished.json";

/// Written when training and scoring have succeeded.
#[derive(Debug, Serialize, Deserialize)]
pub(super) struct Record {
    task: String,
    /// Wall-clock time that the task took, for the reader of the file.
    seconds: f64,
}

impl Record {
    pub(super) fn of(task: &Task, out: &Path) -> Option<Self> {
        let text = fs::read(task.folder(out).join(FILE)).ok()?;
        let record: Self = serde_json::from_slice(&text).ok()?;
        let is_whole = record.task == task.id && task.run_folder(out).join("report.json").is_file();
        is_whole.then_some(record)
    }

    pub(super) fn write(task: &Task, out: &Path, seconds: f64) -> anyhow::Result<()> {
        let file = task.folder(out).join(FILE);
        let record = Self { task: task.id.clone(), seconds };
        let text = serde_json::to_vec(&record)?;
        write_atomically(&file, &text).with_context(|| format!("cannot write {}", file.display()))
    }
}
