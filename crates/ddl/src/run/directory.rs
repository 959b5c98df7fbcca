//! The directory of one run: its files, and how each is written.
//!
//! | file | content |
//! |---|---|
//! | `config.json` | everything that determines the result ([`RunConfig`]) |
//! | `metrics.jsonl` | one line for each epoch |
//! | `optimizer.safetensors` | weights, Adam's state and progress |
//! | `epochs/NNN.safetensors` | weights after some of the epochs |
//! | `experts.safetensors` | tracks of the expert library |
//! | `fingerprints.bin` | hashes of the motions that it was trained on |
//! | `proposal.safetensors` | weights of the proposal network; present once it is trained |
//! | `proposal-state.safetensors` | weights, Adam's state and progress of its unfinished training |
//! | `model.safetensors` | the final weights; present once training is finished |
//! | `report.json` | results of the evaluation |
//! | `moments.json` | moments of the evaluation, to look at |
//! | `evaluation.json` | the conditions of that evaluation |
//! | `.lock` | empty; locked by the process that trains or writes results |
//!
//! Every file is written under a temporary name and renamed.

use crate::error::DdlError;
use crate::run::builtin_model::BuiltinModel;
use crate::run::config::{ConfigFormat, FORMAT, RunConfig};
use crate::run::goal_recipe::GoalRecipe;
use crate::run::lock::RunLock;
use ddl_core::{Setting, remove_temporary_files};
use ddl_network::EpochReport;
use serde::{Serialize, de::DeserializeOwned};
use std::io::Read as _;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Limit of a JSON file of a run: a moment takes some kilobytes, a configuration two.
const MOST_JSON_BYTES: u64 = 1 << 28;

/// An unfinished run is saved at least this often.
pub(crate) const SAVE_EVERY: Duration = Duration::from_secs(30);

/// Path of a run, and of its files.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RunDirectory(PathBuf);

/// A method for the path of each file, and the names of all.
macro_rules! files {
    ($($(#[$doc:meta])* $visible:vis $file:ident => $name:literal,)*) => {
        impl RunDirectory {
            /// The names of the files of a run, except those of the weights after each epoch.
            pub const FILES: &[&str] = &[$($name),*];

            $($(#[$doc])* $visible fn $file(&self) -> PathBuf {
                self.0.join($name)
            })*
        }
    };
}

files! {
    config_file => "config.json",
    metrics_file => "metrics.jsonl",
    /// State of an unfinished run.
    pub(crate) optimizer => "optimizer.safetensors",
    /// Tracks of the expert library.
    pub(crate) experts => "experts.safetensors",
    /// Hashes of the motions that it was trained on.
    pub(crate) fingerprints => "fingerprints.bin",
    /// Weights of the proposal network.
    pub(crate) proposal => "proposal.safetensors",
    pub(crate) proposal_state => "proposal-state.safetensors",
    /// Final weights.
    pub(crate) model => "model.safetensors",
    /// Results.
    pub report => "report.json",
    /// Moments of the evaluation, to look at.
    pub(crate) moments => "moments.json",
    /// The conditions of that evaluation.
    pub(crate) record => "evaluation.json",
}

impl RunDirectory {
    /// The run at `path`, which need not exist.
    pub fn new(path: impl Into<PathBuf>) -> Self {
        Self(path.into())
    }

    /// The directory.
    pub fn path(&self) -> &Path {
        &self.0
    }

    /// Copies the trained goals of another run, so that they are not trained again. Loading them checks that they are
    /// of the same configuration.
    ///
    /// # Errors
    /// When a file cannot be read or written.
    pub fn copy_goals_from(&self, other: &Self) -> Result<(), DdlError> {
        for (from, to) in [(other.experts(), self.experts()), (other.proposal(), self.proposal())] {
            if from.is_file() && !to.exists() {
                std::fs::create_dir_all(&self.0).map_err(|error| DdlError::io(&self.0, error))?;
                let bytes = std::fs::read(&from).map_err(|error| DdlError::io(&from, error))?;
                write_atomically(&to, &bytes)?;
            }
        }
        Ok(())
    }

    /// Weights after an epoch.
    pub(crate) fn epoch(&self, epoch: usize) -> PathBuf {
        self.0.join("epochs").join(format!("{epoch:03}.safetensors"))
    }

    pub(crate) fn has_config(&self) -> bool {
        self.config_file().is_file()
    }

    /// Whether training is finished.
    pub fn is_trained(&self) -> bool {
        self.model().is_file()
    }

    pub(crate) fn has_goals(&self, recipe: &GoalRecipe) -> bool {
        self.experts().is_file() && (recipe.proposal.is_none() || self.proposal().is_file())
    }

    /// Epochs whose weights are kept, ascending.
    ///
    /// # Errors
    /// When the folder cannot be listed.
    pub fn kept_epochs(&self) -> Result<Vec<usize>, DdlError> {
        let folder = self.0.join("epochs");
        if !folder.is_dir() {
            return Ok(Vec::new());
        }
        let entries = std::fs::read_dir(&folder).map_err(|error| DdlError::io(&folder, error))?;
        let mut epochs = Vec::new();
        for entry in entries {
            let name = entry.map_err(|error| DdlError::io(&folder, error))?.file_name();
            let number = name.to_str().and_then(|name| name.strip_suffix(".safetensors"));
            epochs.extend(number.and_then(|number| number.parse::<usize>().ok()));
        }
        epochs.sort_unstable();
        Ok(epochs)
    }

    /// The weights of the best epoch according to metrics.jsonl.
    pub(crate) fn best_epoch(&self, epoch: usize) -> Result<PathBuf, DdlError> {
        let best = self.epoch(epoch);
        if best.is_file() {
            return Ok(best);
        }
        let problem = "is missing, but it is the best epoch according to metrics.jsonl; restore the file, or remove \
                       the directory and train again";
        Err(DdlError::run(&best, problem))
    }

    /// Removes the weights of all epochs but one.
    pub(crate) fn remove_epochs_but(&self, epoch: usize) -> Result<(), DdlError> {
        let others = self.kept_epochs()?;
        for other in others.into_iter().filter(|&other| other != epoch) {
            let file = self.epoch(other);
            std::fs::remove_file(&file).map_err(|error| DdlError::io(&file, error))?;
        }
        Ok(())
    }

    /// Claims the directory for a run: creates it, or checks that it holds the same run. The claim ends when the
    /// returned lock is dropped or the process ends.
    pub(crate) fn claim(&self, config: &RunConfig) -> Result<RunLock, DdlError> {
        let epochs = self.0.join("epochs");
        std::fs::create_dir_all(&epochs).map_err(|error| DdlError::io(&epochs, error))?;
        let lock = RunLock::take(&self.0)?;
        let has_config = self.config_file().exists();
        if has_config && let Some(difference) = self.config()?.origin().difference(&config.origin()) {
            let hint = if difference.starts_with("data.") {
                " (other recordings, or the same recordings with another rate or homography)"
            } else {
                ""
            };
            let problem = format!(
                "holds another run: its {difference} as requested{hint}; choose another directory, or remove this one"
            );
            return Err(DdlError::run(&self.0, problem));
        }
        for folder in [&self.0, &epochs] {
            remove_temporary_files(folder);
        }
        if !has_config {
            write_json(&self.config_file(), config)?;
        }
        Ok(lock)
    }

    /// Reads `config.json`.
    ///
    /// # Errors
    /// [`DdlError::Run`] when it is missing or cannot be parsed.
    pub fn config(&self) -> Result<RunConfig, DdlError> {
        let path = self.config_file();
        if !path.is_file() {
            let inside = self.0.join("run");
            let problem = if !self.0.exists() {
                format!(
                    "is missing: there is neither a run of that name (a training makes one), nor a packed file, nor a \
                     built-in model (the built-in models are {})",
                    BuiltinModel::ALL.map(BuiltinModel::name).join(", ")
                )
            } else if inside.join("config.json").is_file() {
                format!("has no config.json, but {} has one: give that directory", inside.display())
            } else {
                "has no config.json, so it is not the directory of a run (a training makes one)".to_owned()
            };
            return Err(DdlError::run(&self.0, problem));
        }
        let damaged = |error: serde_json::Error| {
            let problem = format!("is damaged ({error}); restore the file, or remove the directory and train again");
            DdlError::run(&path, problem)
        };
        // Check the layout first: the rest may differ in another version.
        let text = read_text(&path)?;
        let ConfigFormat { format } = serde_json::from_str(&text).map_err(damaged)?;
        if format != FORMAT {
            let problem = format!("has layout {format}, this program reads {FORMAT}; train it again");
            return Err(DdlError::run(&self.0, problem));
        }
        serde_json::from_str(&text).map_err(damaged)
    }

    /// Reads `metrics.jsonl`; empty when no epoch is done.
    ///
    /// # Errors
    /// [`DdlError::Run`] with the line that cannot be parsed.
    pub fn metrics(&self) -> Result<Vec<EpochReport>, DdlError> {
        let path = self.metrics_file();
        if !path.is_file() {
            return Ok(Vec::new());
        }
        read_text(&path)?
            .lines()
            .enumerate()
            .map(|(index, line)| {
                serde_json::from_str(line).map_err(|error| {
                    let problem = format!(
                        "line {} is damaged ({error}); restore the file. Without it, train a run with {} again; any \
                             other run can be continued",
                        index + 1,
                        Setting::Patience
                    );
                    DdlError::run(&path, problem)
                })
            })
            .collect()
    }

    pub(crate) fn write_metrics(&self, epochs: &[EpochReport]) -> Result<(), DdlError> {
        let mut text = String::new();
        for epoch in epochs {
            text += &on_one_line(&self.metrics_file(), epoch)?;
            text.push('\n');
        }
        write_atomically(&self.metrics_file(), text.as_bytes())
    }
}

/// Reads a text file of a run, up to a limit.
fn read_text(path: &Path) -> Result<String, DdlError> {
    let io = |error| DdlError::io(path, error);
    let file = std::fs::File::open(path).map_err(io)?;
    let mut text = String::new();
    file.take(MOST_JSON_BYTES + 1).read_to_string(&mut text).map_err(io)?;
    if text.len() as u64 > MOST_JSON_BYTES {
        let problem = format!("is longer than {MOST_JSON_BYTES} bytes, the limit of this file");
        return Err(DdlError::run(path, problem));
    }
    Ok(text)
}

pub(crate) fn read_json<T: DeserializeOwned>(path: &Path) -> Result<T, DdlError> {
    let text = read_text(path)?;
    serde_json::from_str(&text)
        .map_err(|error| DdlError::run(path, format!("is damaged ({error}); delete it and run the command again")))
}

/// Writes a JSON file under a temporary name and renames it.
pub(crate) fn write_json(path: &Path, value: &impl Serialize) -> Result<(), DdlError> {
    let text = serde_json::to_string_pretty(value).map_err(|error| DdlError::run(path, error.to_string()))?;
    write_atomically(path, text.as_bytes())
}

/// Writes a JSON file on one line, for thousands of numbers.
pub(crate) fn write_compact_json(path: &Path, value: &impl Serialize) -> Result<(), DdlError> {
    write_atomically(path, on_one_line(path, value)?.as_bytes())
}

fn on_one_line(path: &Path, value: &impl Serialize) -> Result<String, DdlError> {
    serde_json::to_string(value).map_err(|error| DdlError::run(path, error.to_string()))
}

/// Writes a file under a temporary name in its folder and renames it.
///
/// # Errors
/// When the file cannot be written; an earlier one is unchanged.
pub fn write_atomically(path: &Path, bytes: &[u8]) -> Result<(), DdlError> {
    ddl_core::write_atomically(path, bytes).map_err(|error| DdlError::io(path, error))
}
