//! The plan: which models are trained and scored, as data.

use std::fs;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail, ensure};
use serde::{Deserialize, Serialize};

use crate::whole_file;

use super::cost::Cost;
use super::recipe::Recipe;

/// The published method, what is left of it without each of its two ideas, and the method with another network.
pub(crate) const VARIANTS: [&str; 5] = ["full", "no-goal-shift", "no-dynamics", "star", PERCEPTRON];

/// The published method with the perceptron in the place of STAR.
const PERCEPTRON: &str = "perceptron";

/// How results are scored; each is reported beside the others.
pub(crate) const PROTOCOLS: [&str; 3] = [PUBLISHED_PROTOCOL, "fair", "single"];

/// The protocol that chooses with the truth, and for which the weights of many epochs are kept.
pub(crate) const PUBLISHED_PROTOCOL: &str = "published";

/// Layout of `plan.json`; 3: `single` scores another hypothesis than before, and plans name their protocols and recipe.
const FORMAT: u32 = 3;

/// Everything to do, independent of who does it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct Plan {
    format: u32,
    pub(crate) settings: Settings,
    /// Longest first.
    pub(crate) tasks: Vec<Task>,
}

/// What can be read of the plan of any version.
#[derive(Deserialize)]
struct Layout {
    format: u32,
}

/// What all tasks of a plan share.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct Settings {
    pub(crate) profile: String,
    pub(crate) convention: String,
    /// Folder of the recordings, for a convention that has some.
    pub(crate) data: Option<PathBuf>,
    pub(crate) device: String,
    pub(crate) cargo_profile: String,
    pub(crate) epochs: u32,
    /// Walkers trained on in each epoch; none is as many as the recipe says.
    pub(crate) train_walkers: Option<u32>,
    /// Batches that the proposal network is trained on; none is the program's default.
    pub(crate) proposal_steps: Option<u32>,
    /// Test walkers scored; none is all.
    pub(crate) test_walkers: Option<u32>,
    /// Protocols scored under, each once, in the order of [`PROTOCOLS`].
    pub(crate) protocols: Vec<String>,
    /// What every model is trained by.
    pub(crate) recipe: Recipe,
}

impl Settings {
    /// Whether a model's epoch is chosen with the truth under one of the protocols.
    fn chooses_epochs(&self) -> bool {
        self.protocols
            .iter()
            .any(|protocol| protocol == PUBLISHED_PROTOCOL)
    }
}

/// One model: trained on all folds but one, scored on that one.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct Task {
    /// Unique, and the name of the task's folder.
    pub(crate) id: String,
    pub(crate) fold: String,
    pub(crate) variant: String,
    pub(crate) seed: u64,
    /// Share of a plan's expected time, in arbitrary units, for training and for scoring.
    pub(crate) train_cost: f64,
    pub(crate) evaluate_cost: f64,
}

impl Task {
    pub(crate) fn cost(&self) -> f64 {
        self.train_cost + self.evaluate_cost
    }

    /// Where the program keeps the model and its scores.
    pub(crate) fn run_folder(&self, out: &Path) -> PathBuf {
        self.folder(out).join("run")
    }

    /// Where everything about the task lies.
    pub(crate) fn folder(&self, out: &Path) -> PathBuf {
        out.join(&self.id)
    }
}

impl Plan {
    /// Every fold with every variant and seed, each combination once.
    pub(crate) fn new(
        settings: Settings,
        folds: &[String],
        variants: &[String],
        seeds: &[u64],
    ) -> Result<Self> {
        ensure!(settings.epochs > 0, "training needs at least one epoch");
        ensure!(
            !settings.protocols.is_empty(),
            "there is nothing to do: no protocol"
        );
        let mut tasks: Vec<Task> = Vec::new();
        for fold in folds {
            let cost = Cost::of(
                fold,
                settings.recipe.name,
                settings.epochs,
                settings.train_walkers,
                settings.test_walkers,
            );
            for (variant, seed) in variants
                .iter()
                .flat_map(|variant| seeds.iter().map(move |seed| (variant, seed)))
            {
                let id = format!("{fold}-{variant}-{seed}");
                ensure!(
                    tasks.iter().all(|task| task.id != id),
                    "{id} is asked for twice"
                );
                tasks.push(Task {
                    id,
                    fold: fold.clone(),
                    variant: variant.clone(),
                    seed: *seed,
                    train_cost: cost.train,
                    evaluate_cost: cost.evaluate,
                });
            }
        }
        ensure!(
            !tasks.is_empty(),
            "there is nothing to do: no fold, no variant or no seed"
        );
        // The sort is stable: equal tasks stay in the order they were asked for.
        tasks.sort_by(|one, other| other.cost().total_cmp(&one.cost()));
        Ok(Self {
            format: FORMAT,
            settings,
            tasks,
        })
    }

    /// Arguments with which the program trains the task's model.
    pub(crate) fn train_arguments(&self, task: &Task, out: &Path, threads: usize) -> Vec<String> {
        let mut arguments = vec!["train".to_owned()];
        let mut push = |flag: &str, value: String| arguments.extend([flag.to_owned(), value]);
        push("--convention", self.settings.convention.clone());
        if let Some(data) = &self.settings.data {
            push("--data", data.display().to_string());
        }
        push("--fold", task.fold.clone());
        if task.variant == PERCEPTRON {
            push("--backbone", PERCEPTRON.to_owned());
        } else {
            push("--variant", task.variant.clone());
        }
        push("--seed", task.seed.to_string());
        push("--epochs", self.settings.epochs.to_string());
        if let Some(walkers) = self.settings.train_walkers {
            push("--train-walkers", walkers.to_string());
        }
        if let Some(steps) = self.settings.proposal_steps {
            push("--proposal-steps", steps.to_string());
        }
        let recipe = &self.settings.recipe;
        push("--recipe", recipe.name.to_string());
        if let Some(optimiser) = &recipe.optimiser {
            push("--batch-walkers", optimiser.batch_walkers.to_string());
            push("--learning-rate", optimiser.learning_rate.to_string());
            push("--learning-rate-schedule", optimiser.schedule.to_string());
        }
        push("--out", task.run_folder(out).display().to_string());
        self.common_arguments(threads, &mut push);
        if !self.settings.chooses_epochs() {
            arguments.push("--last-epoch-only".to_owned());
        }
        arguments
    }

    /// Arguments with which the program scores it.
    pub(crate) fn evaluate_arguments(
        &self,
        task: &Task,
        out: &Path,
        threads: usize,
    ) -> Vec<String> {
        let mut arguments = vec!["evaluate".to_owned()];
        let mut push = |flag: &str, value: String| arguments.extend([flag.to_owned(), value]);
        push("--model", task.run_folder(out).display().to_string());
        if let Some(data) = &self.settings.data {
            push("--data", data.display().to_string());
        }
        for protocol in &self.settings.protocols {
            push("--protocol", protocol.clone());
        }
        if let Some(walkers) = self.settings.test_walkers {
            push("--test-walkers", walkers.to_string());
        }
        self.common_arguments(threads, &mut push);
        arguments
    }

    /// Arguments with which the program measures and draws the goals it forecasts towards.
    pub(crate) fn goals_arguments(&self, task: &Task, out: &Path, threads: usize) -> Vec<String> {
        let mut arguments = vec!["goals".to_owned(), "--json".to_owned()];
        let mut push = |flag: &str, value: String| arguments.extend([flag.to_owned(), value]);
        let file = |name: &str| task.folder(out).join(name).display().to_string();
        push("--model", task.run_folder(out).display().to_string());
        push("--measure", "test".to_owned());
        if let Some(data) = &self.settings.data {
            push("--data", data.display().to_string());
        }
        push("--svg", file("goals.svg"));
        push("--output", file("goals.json"));
        push("--device", self.settings.device.clone());
        push("--threads", threads.to_string());
        arguments
    }

    fn common_arguments(&self, threads: usize, push: &mut dyn FnMut(&str, String)) {
        push("--device", self.settings.device.clone());
        push("--threads", threads.to_string());
        push("--progress", "json".to_owned());
    }

    /// Writes `plan.json`, after making sure that what lies in `out` belongs to the same settings.
    ///
    /// Folds, variants and seeds may be added or left out from one call to the next; results made
    /// under other settings are never mixed in.
    pub(crate) fn write(&self, out: &Path) -> Result<()> {
        let file = out.join("plan.json");
        match fs::read(&file) {
            Ok(text) => {
                let damaged = || {
                    format!(
                        "{} is damaged: delete it or choose another --out",
                        file.display()
                    )
                };
                let Layout { format } = serde_json::from_slice(&text).with_context(damaged)?;
                ensure!(
                    format == FORMAT,
                    "{} holds results that another version of the benchmark made (its plan has layout \
                     {format}, this one {FORMAT}): choose another --out, or delete it",
                    out.display()
                );
                let before: Self = serde_json::from_slice(&text).with_context(damaged)?;
                self.check_same_settings(&before, out)?;
            }
            Err(error) if error.kind() == ErrorKind::NotFound => {}
            Err(error) => {
                return Err(error).with_context(|| format!("{} cannot be read", file.display()));
            }
        }
        let text = serde_json::to_vec_pretty(self).context("the plan cannot be written as JSON")?;
        whole_file::write(&file, &text)
    }

    /// Reads the plan of a benchmark folder.
    pub(crate) fn read(folder: &Path) -> Result<Self> {
        let file = folder.join("plan.json");
        let text = fs::read(&file).with_context(|| {
            format!(
                "{} cannot be read: `cargo xtask benchmark` makes such a folder",
                file.display()
            )
        })?;
        serde_json::from_slice(&text).with_context(|| format!("{} is damaged", file.display()))
    }

    fn check_same_settings(&self, before: &Self, out: &Path) -> Result<()> {
        // The recordings are pinned by hash: where they lie makes no difference.
        let comparable = |settings: &Settings| {
            serde_json::to_value(Settings {
                data: None,
                ..settings.clone()
            })
            .context("settings cannot be compared")
        };
        let (now, then) = (comparable(&self.settings)?, comparable(&before.settings)?);
        let differences: Vec<String> = now
            .as_object()
            .into_iter()
            .flatten()
            .filter(|(key, value)| then.get(key) != Some(value))
            .map(|(key, value)| format!("{key} {value} instead of {}", then[key]))
            .collect();
        if differences.is_empty() {
            return Ok(());
        }
        bail!(
            "{} holds results made under other settings ({}): choose another --out, or delete it",
            out.display(),
            differences.join(", ")
        )
    }
}

#[cfg(test)]
#[path = "plan_tests.rs"]
mod tests;
