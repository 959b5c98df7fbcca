//! The plan: which models are trained and scored, as data.

use crate::command::benchmark::method::Method;
use crate::command::benchmark::pace::TaskPace;
use crate::command::benchmark::profile::{Optimiser, Profile};
use crate::command::recipe::Recipe;
use anyhow::{Context as _, bail, ensure};
use ddl::data::{Convention, write_atomically};
use ddl::{DeviceChoice, Protocol};
use serde::{Deserialize, Serialize};
use std::fs;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

/// Layout of `plan.json`; 3: `single` scores another hypothesis than before, and plans name their protocols and recipe.
const FORMAT: u32 = 3;

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct BenchmarkPlan {
    format: u32,
    pub(crate) settings: Settings,
    /// Those of the first method first: the others use their goals.
    pub(crate) tasks: Vec<Task>,
}

/// The part of `plan.json` that every version has.
#[derive(Deserialize)]
struct PlanLayout {
    format: u32,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct Settings {
    pub(crate) profile: Profile,
    pub(crate) convention: Convention,
    pub(crate) data: Option<PathBuf>,
    pub(crate) device: DeviceChoice,
    pub(super) cargo_profile: String,
    pub(crate) epochs: usize,
    /// Pedestrians trained on in each epoch; `None` for the number of the recipe.
    pub(crate) train_pedestrians: Option<usize>,
    /// Batches that the proposal network is trained on; `None` for the default of `ddl train`.
    pub(super) proposal_steps: Option<u64>,
    /// Test pedestrians scored; `None` for all.
    pub(crate) test_pedestrians: Option<usize>,
    /// The protocols of the scores, each once, in the order of [`Protocol`].
    pub(super) protocols: Vec<Protocol>,
    pub(crate) recipe: Training,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct Training {
    pub(crate) name: Recipe,
    pub(super) optimiser: Option<Optimiser>,
}

/// One model: trained on all scenes but one, and scored on that scene.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct Task {
    /// Unique, and the name of the task's folder.
    pub(crate) id: String,
    pub(crate) fold: String,
    pub(crate) variant: Method,
    pub(crate) seed: u64,
}

impl Task {
    pub(crate) fn run_folder(&self, out: &Path) -> PathBuf {
        self.folder(out).join("run")
    }

    pub(super) fn folder(&self, out: &Path) -> PathBuf {
        out.join(&self.id)
    }
}

struct ProgramArguments(Vec<String>);

impl ProgramArguments {
    fn of(command: &str) -> Self {
        Self(vec![command.to_owned()])
    }

    fn option(mut self, name: &str, value: Option<impl ToString>) -> Self {
        if let Some(value) = value {
            self.0.extend([name.to_owned(), value.to_string()]);
        }
        self
    }

    fn path(self, name: &str, path: &Path) -> Self {
        self.option(name, Some(path.display()))
    }
}

impl BenchmarkPlan {
    pub(crate) fn new(
        settings: Settings,
        folds: &[impl ToString],
        methods: &[Method],
        seeds: &[u64],
    ) -> anyhow::Result<Self> {
        let mut tasks: Vec<Task> = Vec::new();
        // The tasks of the first method come first, because the others use the goals that they train.
        for &variant in methods {
            for fold in folds {
                for &seed in seeds {
                    let fold = fold.to_string();
                    let id = format!("{fold}-{}-{seed}", variant.name());
                    ensure!(tasks.iter().all(|task| task.id != id), "the options ask for {id} twice");
                    tasks.push(Task { id, fold, variant, seed });
                }
            }
        }
        Ok(Self { format: FORMAT, settings, tasks })
    }

    /// The earlier task of the same fold and seed, whose goals this task uses.
    pub(super) fn with_same_goals(&self, task: &Task) -> Option<&Task> {
        let first = self.tasks.iter().find(|other: &&Task| (&other.fold, other.seed) == (&task.fold, task.seed))?;
        (first != task).then_some(first)
    }

    /// How the time of a task divides into its stages.
    pub(super) fn pace(&self, task: &Task) -> TaskPace {
        let pace = self.settings.profile.pace(self.settings.recipe.name);
        if self.with_same_goals(task).is_some() {
            return pace.without_goals();
        }
        pace
    }

    pub(super) fn train_arguments(&self, task: &Task, out: &Path, threads: usize) -> Vec<String> {
        let settings = &self.settings;
        let optimiser = settings.recipe.optimiser.as_ref();
        let batch = optimiser.map(|optimiser| optimiser.batch_pedestrians);
        let schedule = optimiser.map(|optimiser| optimiser.schedule);
        let words = ProgramArguments::of("train")
            .option("--convention", Some(settings.convention))
            .option("--data", settings.data.as_ref().map(|data| data.display()))
            .option("--fold", Some(&task.fold))
            .option(task.variant.option(), Some(task.variant.name()))
            .option("--seed", Some(task.seed))
            .option("--epochs", Some(settings.epochs))
            .option("--train-pedestrians", settings.train_pedestrians)
            .option("--proposal-steps", settings.proposal_steps)
            .option("--recipe", Some(settings.recipe.name))
            .option("--batch-pedestrians", batch)
            .option("--learning-rate", optimiser.map(|optimiser| optimiser.learning_rate))
            .option("--learning-rate-schedule", schedule)
            .path("--out", &task.run_folder(out));
        self.on_machine(words, threads).option("--progress", Some("json")).0
    }

    pub(super) fn evaluate_arguments(&self, task: &Task, out: &Path, threads: usize) -> Vec<String> {
        let data = self.settings.data.as_ref().map(|data| data.display());
        let words = ProgramArguments::of("evaluate").path("--model", &task.run_folder(out)).option("--data", data);
        let protocols = self.settings.protocols.iter();
        let words = protocols.fold(words, |words, protocol| words.option("--protocol", Some(protocol)));
        let words = words.option("--test-pedestrians", self.settings.test_pedestrians);
        self.on_machine(words, threads).option("--progress", Some("json")).0
    }

    fn on_machine(&self, words: ProgramArguments, threads: usize) -> ProgramArguments {
        words.option("--device", Some(self.settings.device)).option("--threads", Some(threads))
    }

    /// Writes `plan.json` into `out`.
    ///
    /// # Errors
    /// When the file cannot be written, or `out` holds results of other settings; folds, variants and seeds may differ.
    pub(crate) fn write(&self, out: &Path) -> anyhow::Result<()> {
        if let Some(before) = Self::found(out)? {
            self.check_same_settings(&before, out)?;
        }
        let file = out.join("plan.json");
        let text = serde_json::to_vec_pretty(self)?;
        write_atomically(&file, &text).with_context(|| format!("cannot write {}", file.display()))
    }

    pub(crate) fn read(folder: &Path) -> anyhow::Result<Self> {
        Self::found(folder)?.with_context(|| {
            let folder = folder.display();
            format!("cannot read {folder}/plan.json: --out must be a folder that `ddl benchmark` made")
        })
    }

    /// The plan in a folder, if there is one.
    fn found(folder: &Path) -> anyhow::Result<Option<Self>> {
        let file = folder.join("plan.json");
        let text = match fs::read(&file) {
            Err(error) if error.kind() == ErrorKind::NotFound => return Ok(None),
            text => text.with_context(|| format!("cannot read {}", file.display()))?,
        };
        let damaged = || format!("{} is damaged: choose another --out", file.display());
        let PlanLayout { format } = serde_json::from_slice(&text).with_context(damaged)?;
        ensure!(
            format == FORMAT,
            "{} holds results of another version of the benchmark (its plan has layout {format}, this version writes \
             {FORMAT}): choose another --out, or delete it",
            folder.display()
        );
        Ok(Some(serde_json::from_slice(&text).with_context(damaged)?))
    }

    fn check_same_settings(&self, before: &Self, out: &Path) -> anyhow::Result<()> {
        // The recordings are identified by their hash, so their folder may differ.
        let comparable = |settings: &Settings| serde_json::to_value(Settings { data: None, ..settings.clone() });
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
            "{} holds results of other settings ({}): choose another --out, or delete it",
            out.display(),
            differences.join(", ")
        )
    }
}

#[cfg(test)]
#[path = "plan_tests.rs"]
mod tests;
