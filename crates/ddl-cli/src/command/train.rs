//! `ddl train`: trains a model.

mod bars;
mod finished;

use crate::command::recipe::Recipe;
use crate::command::test_windows::ensure_scene_of_star;
use crate::command::{Machine, RecordingsAt, Reporting};
use crate::interrupt::Interrupt;
use crate::paths::{ModelPath, OutputPlace};
use crate::small_file;
use crate::telling::tell;
use anyhow::{Context as _, bail};
use bars::TrainingBars;
use clap::{Args, ValueEnum};
use ddl::data::{Convention, Dataset, Fold};
use ddl::network::{BackboneKind, LearningRateSchedule, ProposalTraining, StarConfig, TrainingConfig};
use ddl::{
    DdlError, DeviceChoice, GoalModel, GoalRecipe, ModelSource, RunDirectory, TrainingRequest, TrainingStage,
    ValidationPart, Variant,
};
use std::path::PathBuf;

/// Train a model on your own recordings, or on all scenes but one
///
/// The same command continues where an earlier run of it stopped.
#[derive(Debug, Args)]
#[command(after_help = "Examples:\n  \
        ddl train --data recordings --out runs/own\n  \
        ddl train --data recordings --from world --out runs/further\n  \
        ddl train --data recordings --convention own --fold lobby --out runs/without-lobby\n  \
        ddl train --fold eth --epochs 10 --out runs/eth")]
pub(crate) struct Train {
    /// Data convention: star, social-gan, simulated or own [default: own without --fold, star with it]
    #[arg(long)]
    convention: Option<Convention>,
    #[command(flatten)]
    recordings: RecordingsAt,
    /// Scene left out of training: eth, hotel, univ, zara1 or zara2; simulated: corridor, crossing, plaza, bottleneck
    /// or doorway; own: the name of a file without its extension [default for own: none]
    #[arg(long)]
    fold: Option<String>,
    /// Variant: full, no-goal-shift, no-dynamics or star (without both)
    #[arg(long, default_value = "full")]
    variant: Variant,
    /// Shape and training of the network: recommended (whole paths to estimated goals; minutes on a CPU) or published
    /// (single steps, 200 epochs; hours); the following options change parts of it
    #[arg(long, value_enum, default_value_t = Recipe::Recommended)]
    recipe: Recipe,
    /// Network behind the dynamics: star (the paper's Transformer) or perceptron (reads only the goal and the observed
    /// motion) [default: star]
    #[arg(long)]
    backbone: Option<BackboneKind>,
    /// Width of the hidden layer of each feed-forward block; narrower blocks are faster (docs/performance.md) [default:
    /// 32, published 2048]
    #[arg(long)]
    feed_forward_width: Option<i64>,
    /// Encoder layers of each of the two spatial encoders [default: 1, published 2]
    #[arg(long, value_name = "LAYERS")]
    spatial_layers: Option<usize>,
    /// Model to start from instead of random weights: a built-in model such as world, a packed file or the directory of
    /// a run, whose sizes are taken; `none` for random weights. Training takes fewer and smaller steps, and the
    /// starting model is kept if training does not improve it on the validation part [default: none; world for own
    /// recordings with fewer than 10000 pedestrian-windows]
    #[arg(long, value_name = "MODEL", value_hint = clap::ValueHint::AnyPath)]
    from: Option<ModelPath>,
    /// Random seed
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Epochs [default: 20, published 200, with --from 5]
    #[arg(long)]
    epochs: Option<usize>,
    /// Pedestrians per epoch, in a seeded order of the training set [default: 5000, published all]
    #[arg(long = "train-pedestrians")]
    pedestrians_per_epoch: Option<usize>,
    /// Pedestrians per batch [default: 64, published 256]
    #[arg(long)]
    batch_pedestrians: Option<usize>,
    /// Largest step size of Adam [default: 1e-3, published 1.5e-3, with --from 1e-4]
    #[arg(long)]
    learning_rate: Option<f64>,
    /// Schedule of the step size: constant or cosine [default: cosine, published constant]
    #[arg(long)]
    learning_rate_schedule: Option<LearningRateSchedule>,
    /// Share of the training recordings' time, at their ends, kept for validation [default: 0; for own recordings 0.2,
    /// or 0 and whole recordings if their ends hold too few windows]
    #[arg(long)]
    validation: Option<f64>,
    /// Training recordings kept for validation as a whole, such as `uni_examples,zara03`
    #[arg(long, value_delimiter = ',')]
    validation_recordings: Vec<String>,
    /// Stop when the validation error has not fallen for this many epochs, and keep the best epoch; 0 trains all epochs
    /// [default: 0; for own recordings 10]
    #[arg(long, value_name = "EPOCHS")]
    patience: Option<usize>,
    /// Source of goals: proposed by a network that is trained first, or retrieved from the training tracks [default:
    /// proposed, published retrieved unless --proposal-steps is given]
    #[arg(long, value_enum)]
    goals: Option<GoalsFrom>,
    #[arg(long, help = format!(
        "Batches that the proposal network is trained on [default: {}, with --from 300]",
        ProposalTraining::default().steps
    ))]
    proposal_steps: Option<u64>,
    /// JSON file with all settings of the goals: a run's config.json, or its part `goals`
    #[arg(long, value_name = "FILE", conflicts_with_all = ["goals", "proposal_steps"])]
    goal_recipe: Option<PathBuf>,
    /// Stop when the goals are trained; the same command without this option continues
    #[arg(long)]
    only_goals: bool,
    /// Directory of the run
    #[arg(long, value_hint = clap::ValueHint::AnyPath)]
    out: OutputPlace,
    #[command(flatten)]
    machine: Machine,
    #[command(flatten)]
    reporting: Reporting,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum GoalsFrom {
    Proposed,
    Retrieved,
}

impl Train {
    pub(crate) fn run(self) -> anyhow::Result<()> {
        self.machine.prepare()?;
        let interrupt = Interrupt::catch()?;
        let (convention, fold) = self.scene()?;
        let dataset = self.recordings.dataset(convention)?;
        let part = self.validation_part(&dataset, &fold)?;
        let is_validated = !part.is_empty();
        let patience = self.patience.unwrap_or(part.patience(convention));
        if self.patience.is_some_and(|patience| patience > 0) && !is_validated {
            let validation = part.share;
            bail!(DdlError::Patience { patience, validation });
        }
        let from = self.starting_model(&dataset, &fold, &part)?;
        let mut goals = self.goal_recipe(from.is_some())?;
        let (mut star, training) = self.recipe(from.is_some());
        if let Some(from) = &from {
            self.take_sizes(from, &mut star, &mut goals)?;
        }
        let mut request = TrainingRequest::recommended(fold, RunDirectory::new(self.out));
        request.star = star;
        request.training = training;
        request.validation = part.share;
        request.validation_recordings = part.recordings;
        request.from = from;
        request.patience = (patience > 0).then_some(patience);
        request.goals = goals;
        request.units = self.recordings.units.told()?;
        if self.only_goals {
            request.until = TrainingStage::Goals;
        }
        request.device = self.machine.device;
        request.commit.clone_from(&self.reporting.commit);
        let mut progress = TrainingBars::new(self.reporting.telling.progress);
        let trained = ddl::train(&request, &dataset, |now| {
            progress.tell(now);
            interrupt.flow()
        });
        let stood = progress.close();
        trained.map_err(|error| match error {
            DdlError::Interrupted => {
                anyhow::Error::new(error).context(format!("{}, {stood}", request.out.path().display()))
            }
            error => error.into(),
        })?;
        if let (Some(from), true) = (&request.from, is_validated) {
            let fold = ddl::fold_by_name(&dataset, &request.fold)?;
            warn_of_known(from, &fold, request.validation, &request.validation_recordings)?;
        }
        let compared = finished::compare_with_builtin(&request, &dataset, &self.reporting, &interrupt)?;
        finished::print(&request, compared.as_ref(), &self.recordings, &self.reporting)
    }

    fn validation_part(&self, dataset: &Dataset, fold: &str) -> anyhow::Result<ValidationPart> {
        let recordings = &self.validation_recordings;
        let part = ValidationPart { share: self.validation.unwrap_or(0.0), recordings: recordings.clone() };
        let said = self.validation.is_some() || !recordings.is_empty();
        if said || dataset.convention() != Convention::Own {
            return Ok(part);
        }
        let part = ValidationPart::of_own(&ddl::fold_by_name(dataset, fold)?);
        if !part.recordings.is_empty() {
            let count = part.recordings.len();
            let whole = if count == 1 { "1 recording is" } else { "some recordings are" };
            tell(format_args!(
                "note: the ends of these recordings hold too few windows for validation: {whole} kept for \
                 validation as a whole (--validation-recordings {})",
                part.recordings.join(",")
            ));
        }
        Ok(part)
    }

    /// The model to start from: the named one, or for few own recordings the built-in one if it has the requested
    /// sizes.
    fn starting_model(
        &self,
        dataset: &Dataset,
        fold: &str,
        part: &ValidationPart,
    ) -> anyhow::Result<Option<ModelSource>> {
        if let Some(named) = &self.from {
            let none = named.as_os_str() == "none";
            return Ok((!none).then(|| ModelSource::named(named)));
        }
        let Some((model, pedestrians)) = ddl::starting_model(dataset, fold, part)? else {
            return Ok(None);
        };
        let usual = self.variant == Variant::Full
            && self.recipe == Recipe::Recommended
            && self.feed_forward_width.is_none()
            && self.spatial_layers.is_none()
            && self.backbone.is_none()
            && self.goals != Some(GoalsFrom::Retrieved)
            && self.goal_recipe.is_none();
        if !usual {
            tell(format_args!(
                "note: only {pedestrians} pedestrian-windows for training, from random weights, because the options \
                 name another network than that of the built-in model"
            ));
            return Ok(None);
        }
        tell(format_args!(
            "note: only {pedestrians} pedestrian-windows for training: it starts from the weights of the built-in \
             model {model} (--from none for random weights)"
        ));
        Ok(Some(ModelSource::Builtin(model)))
    }

    fn scene(&self) -> anyhow::Result<(Convention, String)> {
        match (self.convention, &self.fold) {
            (Some(convention), Some(fold)) => Ok((convention, fold.clone())),
            (None, Some(fold)) => {
                ensure_scene_of_star(fold)?;
                Ok((Convention::Star, fold.clone()))
            }
            (None, None) if !self.recordings.is_named() => bail!(
                "nothing to train on: give your own recordings (--data FOLDER), or the scene of ETH/UCY to leave out \
                 (--fold eth, hotel, univ, zara1 or zara2)"
            ),
            (None | Some(Convention::Own), None) => Ok((Convention::Own, Fold::NO_HELD_OUT.to_owned())),
            (Some(convention), None) => {
                let fold_names: Vec<&str> = convention.fold_names().collect();
                bail!("give the fold to leave out, --fold NAME with one of {}", fold_names.join(", "))
            }
        }
    }

    fn recipe(&self, further: bool) -> (StarConfig, TrainingConfig) {
        let (mut star, mut training) = match self.recipe {
            Recipe::Recommended => (
                StarConfig::recommended(self.variant),
                if further { ddl::fine_tuning_config(self.variant) } else { TrainingConfig::recommended(self.variant) },
            ),
            Recipe::Published => (StarConfig::published(self.variant), TrainingConfig::published()),
        };
        self.set_sizes(&mut star);
        set(&mut training.epochs, self.epochs);
        set(&mut training.batch_pedestrians, self.batch_pedestrians);
        set(&mut training.learning_rate, self.learning_rate);
        set(&mut training.learning_rate_schedule, self.learning_rate_schedule);
        set(&mut training.pedestrians_per_epoch, self.pedestrians_per_epoch.map(Some));
        training.seed = self.seed;
        (star, training)
    }

    /// Takes the sizes of the networks from the starting model, except those that are requested.
    fn take_sizes(&self, from: &ModelSource, star: &mut StarConfig, goals: &mut GoalRecipe) -> anyhow::Result<()> {
        if self.recipe != Recipe::Recommended {
            return Ok(());
        }
        let config = from.config()?;
        if config.star.variant == star.variant {
            *star = config.star;
            self.set_sizes(star);
        }
        let of_from = config.goals.proposal.filter(|_| self.goal_recipe.is_none());
        if let (Some(proposal), Some(theirs)) = (&mut goals.proposal, of_from) {
            proposal.network = theirs.network;
            proposal.unforeseen_share = theirs.unforeseen_share;
        }
        Ok(())
    }

    fn set_sizes(&self, star: &mut StarConfig) {
        set(&mut star.backbone, self.backbone);
        set(&mut star.feed_forward_width, self.feed_forward_width);
        set(&mut star.spatial_layers, self.spatial_layers);
    }

    fn goal_recipe(&self, further: bool) -> anyhow::Result<GoalRecipe> {
        if let Some(path) = &self.goal_recipe {
            let text = small_file::read(path)?;
            let wrong = || format!("{} holds no settings of goals", path.display());
            let mut recipe: serde_json::Value =
                serde_json::from_str(&text).with_context(|| format!("{} is not JSON", path.display()))?;
            // A whole config.json is also accepted.
            if let Some(goals) = recipe.get_mut("goals") {
                recipe = goals.take();
            }
            return serde_json::from_value(recipe).with_context(wrong);
        }
        match (self.goals, self.proposal_steps) {
            (Some(GoalsFrom::Retrieved), Some(_)) => {
                bail!("--proposal-steps needs --goals proposed: retrieved goals have no network")
            }
            (Some(GoalsFrom::Retrieved), None) => Ok(GoalRecipe::retrieved(self.seed)),
            // The paper has no network of goals.
            (None, None) if self.recipe == Recipe::Published => Ok(GoalRecipe::retrieved(self.seed)),
            (_, steps) => {
                let mut recipe =
                    if further { ddl::fine_tuning_goal_recipe(self.seed) } else { GoalRecipe::proposed(self.seed) };
                if let (Some(proposal), Some(steps)) = (&mut recipe.proposal, steps) {
                    let training = &mut proposal.training;
                    let memory = training.memory.steps as f64 / training.steps as f64;
                    training.memory.steps = (memory * steps as f64).ceil() as u64;
                    training.steps = steps;
                }
                Ok(recipe)
            }
        }
    }
}

/// A validation part that the starting model has seen is no measure.
///
/// Of all recordings a `share` is kept for validation, and `whole` ones as a whole.
fn warn_of_known(from: &ModelSource, fold: &Fold<'_>, share: f64, whole: &[String]) -> anyhow::Result<()> {
    let goals = GoalModel::open(from, DeviceChoice::Cpu)?;
    let is_validated = |name: &str| share > 0.0 || whole.iter().any(|kept| kept == name);
    let recordings = fold.training_recordings().iter().filter(|recording| is_validated(recording.name()));
    let known = recordings.filter(|recording| goals.known_share(recording).is_some());
    let known: Vec<&str> = known.map(|recording| recording.name()).collect();
    if !known.is_empty() {
        tell(format_args!(
            "warning: the starting model was trained on {}: errors on their validation part are too small",
            known.join(", ")
        ));
    }
    Ok(())
}

fn set<T>(place: &mut T, option: Option<T>) {
    if let Some(value) = option {
        *place = value;
    }
}
