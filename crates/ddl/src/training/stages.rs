//! The stages of a training in order: the goals, then the forecasting network.

use crate::device::Device;
use crate::error::DdlError;
use crate::goals::model::GoalModel;
use crate::model::ddl::Ddl;
use crate::run::config::{FORMAT, RunConfig, TrainingData};
use crate::run::directory::{RunDirectory, SAVE_EVERY, write_atomically};
use crate::run::folds::{fold_by_name, learned_from, training_rule};
use crate::run::goal_recipe::GoalRecipe;
use crate::run::starting_model::InitialModel;
use crate::run::training_data::{digest, digest_of_recording};
use crate::training::best_epoch::best_epoch;
use crate::training::early_stopping::{EarlyStopping, better_goals};
use crate::training::goals::{self, GoalStage};
use crate::training::request::{TrainingProgress, TrainingRequest, TrainingStage, TrainingStep};
use crate::training::starting_weights::StartingWeights;
use crate::trust::fingerprints::{TrackFingerprints, tracks_of};
use ddl_core::Window;
use ddl_data::{Convention, Dataset, Fold, WindowRule};
use ddl_goal::{GoalEstimatorParams, RetrievalFrame};
use ddl_network::weights::{Weights, load_weights, save_weights};
use ddl_network::{EpochReport, Objective};
use ddl_star::{LIBTORCH_VERSION, StarError, TorchNetwork, Trainer};
use std::collections::BTreeMap;
use std::ops::{ControlFlow, RangeInclusive};
use std::time::Instant;

/// Weights of at most about this many epochs are kept for the protocol `published`.
const KEPT_EPOCHS: usize = 20;

pub(super) fn train(
    request: &TrainingRequest,
    dataset: &Dataset,
    mut observe: impl FnMut(&TrainingProgress) -> ControlFlow<()>,
) -> Result<(), DdlError> {
    // Check everything before claiming the directory, so that a mistake leaves no run behind.
    check(request)?;
    let device = Device::open(request.device)?;
    let fold = fold_by_name(dataset, &request.fold)?.with_validation_recordings(&request.validation_recordings)?;
    let window_rule = training_rule(dataset.convention());
    let windows = training_windows(request, &fold, window_rule)?;
    let starting_weights = || {
        let from = request.from.as_ref();
        from.map(|source| StartingWeights::of(source, &request.star, &request.goals, request.device)).transpose()
    };
    let start = starting_weights()?;
    let run = &request.out;
    let began_with = start.as_ref().map(|start| start.record.clone());
    let config = config_of(request, dataset.convention(), &fold, window_rule, &windows, began_with, device);
    let _claimed = run.claim(&config)?;
    if !run.fingerprints().is_file() {
        let mut fingerprints = TrackFingerprints::of(learned_from(&fold).flat_map(tracks_of));
        if let Some(start) = &start {
            fingerprints = fingerprints.with(&start.fingerprints);
        }
        write_atomically(&run.fingerprints(), &fingerprints.to_bytes())?;
    }
    let (network, proposal) = start.map_or((None, None), |start| (Some(start.network), start.proposal));
    let better = |trained| match starting_weights()? {
        None => Ok(trained),
        Some(start) => better_goals(start, trained, run, &config, device, &fold),
    };
    let stage = GoalStage {
        recipe: config.goals.proposal.as_ref(),
        run,
        origin: config.goals_origin(),
        device: device.torch()?,
    };
    let recordings = fold.training_recordings();
    goals::train(&stage, &windows, recordings, proposal, better, |steps, step| {
        let step = TrainingStep::Goals(step.clone());
        observe(&TrainingProgress { steps, step })
    })?;
    if run.is_trained() {
        // A finished run must load: this reports a file that has been damaged since.
        return Ddl::load(run.path(), request.device).map(drop);
    }
    if request.until == TrainingStage::Goals {
        return Ok(());
    }
    let stage = NetworkStage { config: &config, run, device };
    stage.train(&fold, windows, network, observe)
}

/// The windows to train on, if they and the validation part suffice.
fn training_windows(request: &TrainingRequest, fold: &Fold<'_>, rule: WindowRule) -> Result<Vec<Window>, DdlError> {
    let windows = if request.validation > 0.0 {
        fold.training_split(rule, request.validation).training
    } else {
        fold.training_windows(rule)
    };
    if windows.is_empty() {
        return Err(StarError::NoTrainingWindows.into());
    }
    ensure_patience(request, fold, rule)?;
    ensure_enough_tracks(&request.goals, &windows)?;
    Ok(windows)
}

fn check(request: &TrainingRequest) -> Result<(), DdlError> {
    request.star.check()?;
    request.training.check(request.star.variant)?;
    request.goals.check()?;
    if (0.0..1.0).contains(&request.validation) { Ok(()) } else { Err(DdlError::Validation(request.validation)) }
}

/// The `config.json` of a run, from the request, the training data and the device.
fn config_of(
    request: &TrainingRequest,
    convention: Convention,
    fold: &Fold<'_>,
    window_rule: WindowRule,
    windows: &[Window],
    began_with: Option<InitialModel>,
    device: Device,
) -> RunConfig {
    RunConfig {
        format: FORMAT,
        star: request.star.clone(),
        training: request.training.clone(),
        goals: request.goals.clone(),
        data: TrainingData {
            convention,
            fold: fold.name().to_owned(),
            window_rule,
            validation: request.validation,
            validation_recordings: request.validation_recordings.clone(),
            windows: windows.len(),
            pedestrians: windows.iter().map(Window::len).sum(),
            sha256: digest(windows),
            recordings: match convention {
                Convention::Own => learned_from(fold)
                    .map(|recording| (recording.name().to_owned(), digest_of_recording(recording)))
                    .collect(),
                _ => BTreeMap::new(),
            },
        },
        keep_every: match request.patience {
            // any of them may be the best
            Some(_) => 1,
            None => request.training.epochs.div_ceil(KEPT_EPOCHS),
        },
        patience: request.patience,
        from: began_with,
        units: request.units,
        commit: request.commit.clone(),
        libtorch: LIBTORCH_VERSION.to_owned(),
        device: device.name().to_owned(),
    }
}

/// Early stopping needs a validation part.
fn ensure_patience(request: &TrainingRequest, fold: &Fold<'_>, rule: WindowRule) -> Result<(), DdlError> {
    let (validation, Some(patience)) = (request.validation, request.patience) else {
        return Ok(());
    };
    let measured = validation > 0.0 || !request.validation_recordings.is_empty();
    if patience == 0 || !measured {
        return Err(DdlError::Patience { patience, validation });
    }
    if fold.training_split(rule, validation).validation.is_empty() {
        return Err(DdlError::NothingToValidateOn {
            recordings: fold.training_recordings().len() + fold.validation_recordings().len(),
        });
    }
    Ok(())
}

/// Evaluation also runs the published estimator, which retrieves this many tracks.
fn ensure_enough_tracks(goals: &GoalRecipe, windows: &[Window]) -> Result<(), DdlError> {
    let (published, retrieval) = (GoalEstimatorParams::published(), &goals.retrieval);
    let (tracks, experts) = (
        windows.iter().map(Window::len).sum::<usize>(),
        match retrieval.frame {
            RetrievalFrame::World => published.experts.max(retrieval.experts),
            // a smaller library is used as a whole
            RetrievalFrame::Heading => published.experts,
        },
    );
    if tracks < experts {
        return Err(DdlError::TooFewTracks { tracks, experts });
    }
    Ok(())
}

/// The training of the forecasting network, on single steps or on whole paths to the goals of the run.
fn trainer(
    config: &RunConfig,
    windows: Vec<Window>,
    goals: &GoalModel,
    network: TorchNetwork,
) -> Result<Trainer, DdlError> {
    let windows: Vec<Window> = windows.into_iter().filter(Window::has_future).collect();
    let training_goals = match config.training.objective {
        Objective::NextStep => None,
        Objective::Walk => Some(goals.training_goals(&windows)?),
    };
    Ok(Trainer::new(network, windows, training_goals, config.training.clone())?)
}

/// Checks that the record is complete: the best epoch is chosen from it.
fn ensure_every_epoch_is_recorded(
    epochs: &[EpochReport],
    mut measured: RangeInclusive<usize>,
    run: &RunDirectory,
) -> Result<(), DdlError> {
    let recorded = |epoch: usize| {
        let mut reports = epochs.iter();
        reports.any(|report| report.epoch == epoch && report.validation.is_some())
    };
    match measured.find(|&epoch| !recorded(epoch)) {
        None => Ok(()),
        Some(epoch) => Err(DdlError::run(
            run.path(),
            format!(
                "has no record of epoch {epoch} in metrics.jsonl, from which the best epoch is chosen; restore the \
                 file, or remove the directory and train again",
            ),
        )),
    }
}

/// The second stage: the forecasting network, to the goals of the run.
struct NetworkStage<'a> {
    config: &'a RunConfig,
    run: &'a RunDirectory,
    device: Device,
}

impl NetworkStage<'_> {
    /// Trains to the end, from the weights of `start` if given, saving the state that a later call needs to continue.
    fn train(
        &self,
        fold: &Fold<'_>,
        windows: Vec<Window>,
        start: Option<Weights>,
        mut observe: impl FnMut(&TrainingProgress) -> ControlFlow<()>,
    ) -> Result<(), DdlError> {
        let (config, run, origin) = (self.config, self.run, self.config.network_origin());
        let goals = GoalModel::of_run(run.clone(), config.clone(), self.device)?;
        let stopping = EarlyStopping::of(&goals, fold)?;
        let network = TorchNetwork::new(config.star.clone(), config.training.seed, self.device.torch()?)?;
        if let Some(start) = start {
            network.parameters().set(&start)?;
        }
        let mut trainer = trainer(config, windows, &goals, network)?;
        if run.optimizer().is_file() {
            trainer.resume(&origin, &run.optimizer())?;
        }
        let mut epochs = self.recorded_epochs(&trainer, stopping.as_ref())?;
        let mut saved = Instant::now();
        let is_over = |epochs: &[EpochReport]| stopping.as_ref().is_some_and(|stopping| stopping.is_over(epochs));
        while !trainer.is_finished() && !is_over(&epochs) {
            let mut step = trainer.step()?;
            if let Some(epoch) = &mut step.finished_epoch {
                if let Some(stopping) = &stopping {
                    epoch.validation = Some(self.min_ade(&trainer, stopping)?);
                }
                epochs.push(epoch.clone());
                if epoch.epoch % config.keep_every == 0 || trainer.is_finished() {
                    save_weights(&trainer.weights()?, &origin, &run.epoch(epoch.epoch))?;
                }
                run.write_metrics(&epochs)?;
            }
            let due = step.finished_epoch.is_some() || saved.elapsed() > SAVE_EVERY;
            let (steps, step) = (trainer.steps(), TrainingStep::Network(step));
            let progress = TrainingProgress { steps, step };
            let stop = observe(&progress).is_break();
            if due || stop {
                trainer.save(&origin, &run.optimizer())?;
                saved = Instant::now();
            }
            if stop && !trainer.is_finished() && !is_over(&epochs) {
                return Err(DdlError::Interrupted);
            }
        }
        self.keep_model(trainer.weights()?, &epochs)
    }

    /// The epochs before this call, with the error of the starting weights as epoch 0 if training begins with a model.
    fn recorded_epochs(
        &self,
        trainer: &Trainer,
        stopping: Option<&EarlyStopping>,
    ) -> Result<Vec<EpochReport>, DdlError> {
        let (run, completed) = (self.run, trainer.completed_epochs());
        let mut epochs = run.metrics()?;
        epochs.retain(|report| report.epoch <= completed);
        let Some(stopping) = stopping else {
            return Ok(epochs);
        };
        if stopping.first_epoch() == 0 && trainer.steps().done == 0 {
            save_weights(&trainer.weights()?, &self.config.network_origin(), &run.epoch(0))?;
            epochs = vec![EpochReport {
                epoch: 0,
                loss: 0.0,
                batches: 0,
                seconds: 0.0,
                validation: Some(self.min_ade(trainer, stopping)?),
            }];
            run.write_metrics(&epochs)?;
        }
        ensure_every_epoch_is_recorded(&epochs, stopping.first_epoch()..=completed, run)?;
        Ok(epochs)
    }

    fn min_ade(&self, trainer: &Trainer, stopping: &EarlyStopping) -> Result<f64, DdlError> {
        let weights = trainer.weights()?;
        let network = self.device.forecasting(&self.config.star, |_| Ok(weights))?;
        stopping.min_ade(&*network)
    }

    /// Writes the weights of the best epoch, or of the last without a validation part.
    fn keep_model(&self, last: Weights, epochs: &[EpochReport]) -> Result<(), DdlError> {
        let (run, origin) = (self.run, self.config.network_origin());
        let mut weights = last;
        if let Some(best) = best_epoch(epochs) {
            // Read the file before the others are removed, to report one that has been damaged since.
            weights = load_weights(weights.layout(), &origin, &run.best_epoch(best.epoch)?)?;
            run.remove_epochs_but(best.epoch)?;
        }
        // Last, because the model file marks the run as finished.
        Ok(save_weights(&weights, &origin, &run.model())?)
    }
}
