//! Training of one fold into a run directory, stopped and resumed at will.

use crate::early_stopping::{EarlyStopping, best_epoch, better_goals};
use crate::run_config::{FORMAT, RunConfig, TrainingData};
use crate::run_directory::{RunDirectory, SAVE_EVERY};
use crate::starting_model::{StartingModel, StartingWeights};
use crate::{Ddl, DdlError, GoalModel, GoalRecipe, ModelSource, TrackUnits, goal_training, sha256};
use ddl_data::{Convention, DataError, Dataset, Fold, Recording, Window, WindowRule};
use ddl_goal::RetrievalFrame;
use ddl_star::{
    ComputeDevice, DeviceChoice, EpochReport, LIBTORCH_VERSION, Objective, Origin, ProposalStep,
    StarConfig, StarError, StarNetwork, StepReport, Trainer, TrainingConfig, load_parameters,
    save_parameters,
};
use sha2::{Digest as _, Sha256};
use std::collections::BTreeMap;
use std::ops::{ControlFlow, RangeInclusive};
use std::time::Instant;

/// Weights of at most about this many epochs are kept for the protocol `published`.
const KEPT_EPOCHS: usize = 20;

/// What to train, and where to put it.
#[derive(Debug, Clone)]
pub struct TrainingRequest {
    /// The fold whose test scene is left out.
    pub fold: String,
    /// Size and variant of the forecasting network.
    pub star: StarConfig,
    /// How to train.
    pub training: TrainingConfig,
    /// Share of the training recordings' time, at their ends, kept for validation; 0 for none.
    pub validation: f64,
    /// Training recordings kept for validation whole.
    pub validation_recordings: Vec<String>,
    /// What the goals come from.
    pub goals: GoalRecipe,
    /// The model whose weights both networks begin with; `None`: random ones. With [`patience`](Self::patience) it is an epoch like the others, number 0, so that
    /// no epoch is taken that is worse on the validation part than the first weights. Goals and familiarity are the run's own from the start.
    pub from: Option<ModelSource>,
    /// End early when the validation error has not fallen for so many epochs, and take the best epoch for the model; `None`: all epochs, and the
    /// last is the model.
    pub patience: Option<usize>,
    /// What the numbers of own recordings mean, for the record; `None` where nothing was said.
    pub units: Option<TrackUnits>,
    /// Keep the weights of the last epoch alone, and not those of some 20 among which the protocol `published` chooses.
    pub last_epoch_only: bool,
    /// The last stage to train; a later call may go on.
    pub until: TrainingStage,
    /// The run's directory.
    pub out: RunDirectory,
    /// Where to compute.
    pub device: DeviceChoice,
    /// Commit of the program, for the record.
    pub commit: String,
}

/// The stages of a training, in order.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum TrainingStage {
    /// What the goals come from: the expert library and the proposal network.
    Goals,
    /// The forecasting network.
    Network,
}

/// What training tells its observer.
#[derive(Debug, Clone, PartialEq)]
pub struct TrainingProgress {
    /// Steps of the stage done and in all.
    pub steps: (u64, u64),
    /// The step just done.
    pub step: TrainingStep,
}

/// A step of one of the stages.
#[derive(Debug, Clone, PartialEq)]
pub enum TrainingStep {
    /// Of the proposal network.
    Goals(ProposalStep),
    /// Of the forecasting network.
    Network(StepReport),
}

/// Trains the fold, or goes on where an earlier call stopped, or returns at once when it is done.
///
/// `observe` is called after every step and may ask to stop: the state is then saved and the result
/// is [`DdlError::Interrupted`].
///
/// # Errors
/// Unreadable data, a directory that holds another run, a device that is not there, or a loss that
/// is no longer a number (the last good state is kept).
pub fn train(
    request: &TrainingRequest,
    dataset: &Dataset,
    mut observe: impl FnMut(&TrainingProgress) -> ControlFlow<()>,
) -> Result<(), DdlError> {
    // Everything is checked before the directory is claimed: a mistake must not leave a run behind.
    request.star.check()?;
    request.training.check()?;
    request.training.check_for(request.star.variant)?;
    request.goals.check()?;
    if !(0.0..1.0).contains(&request.validation) {
        return Err(DdlError::Validation(request.validation));
    }
    let device = ComputeDevice::open(request.device)?;
    let fold = fold_of(dataset, &request.fold)?.set_apart(&request.validation_recordings)?;
    let window_rule = training_rule(dataset.convention());
    let windows = if request.validation > 0.0 {
        fold.training_split(window_rule, request.validation)
            .training
    } else {
        fold.training_windows(window_rule)
    };
    if windows.is_empty() {
        return Err(StarError::NoTrainingWindows.into());
    }
    ensure_patience(request, &fold, window_rule)?;
    ensure_enough_tracks(&request.goals, &windows)?;
    let starting_weights = || {
        let from = request.from.as_ref();
        let sizes = (&request.star, &request.goals);
        from.map(|source| StartingWeights::of(source, sizes, request.device))
            .transpose()
    };
    let start = starting_weights()?;
    let run = &request.out;
    let began_with = start.as_ref().map(|start| start.record.clone());
    let config = config_of(
        request,
        dataset,
        (&fold, window_rule, &windows),
        (began_with, device),
    );
    let _claimed = run.claim(&config)?;
    let (network, proposal) =
        start.map_or((None, None), |start| (Some(start.network), start.proposal));
    let better = |trained| match starting_weights()? {
        None => Ok(trained),
        Some(start) => better_goals(start, trained, (run, &config), &fold),
    };
    goal_training::train(
        config.goals.proposal.as_ref(),
        (proposal, better),
        &windows,
        (run, &config.goals_origin()),
        device,
        |steps, step| {
            let step = TrainingStep::Goals(step.clone());
            observe(&TrainingProgress { steps, step })
        },
    )?;
    if run.is_trained() {
        // Finished is what can be loaded: a file that was damaged since is named.
        return Ddl::load(run.path(), request.device).map(drop);
    }
    if request.until == TrainingStage::Goals {
        return Ok(());
    }
    let origin = config.network_origin();
    let goals = GoalModel::of_run(run.clone(), config.clone(), device)?;
    let early_stopping = EarlyStopping::of(&goals, &fold)?;
    let network = match network {
        Some(network) => network,
        None => StarNetwork::new(config.star.clone(), config.training.seed, device)?,
    };
    let mut trainer = trainer(&config, windows, &goals, network)?;
    if run.optimizer().is_file() {
        trainer.resume(&origin, &run.optimizer())?;
    }
    let kept = (config.keep_every, early_stopping.as_ref());
    run_epochs(&mut trainer, (run, &origin), kept, observe)
}

/// What a run's `config.json` says: the request, what is learned from, and what it is computed with.
fn config_of(
    request: &TrainingRequest,
    dataset: &Dataset,
    (fold, window_rule, windows): (&Fold<'_>, WindowRule, &[Window]),
    (began_with, device): (Option<StartingModel>, ComputeDevice),
) -> RunConfig {
    RunConfig {
        format: FORMAT,
        star: request.star.clone(),
        training: request.training.clone(),
        goals: request.goals.clone(),
        data: TrainingData {
            convention: dataset.convention(),
            fold: fold.name().to_owned(),
            window_rule,
            validation: request.validation,
            validation_recordings: request.validation_recordings.clone(),
            windows: windows.len(),
            walkers: windows.iter().map(Window::len).sum(),
            sha256: digest(windows),
            recordings: match dataset.convention() {
                Convention::Own => learned_from(fold)
                    .map(|recording| (recording.name().to_owned(), digest_of_recording(recording)))
                    .collect(),
                _ => BTreeMap::new(),
            },
        },
        keep_every: match (request.patience, request.last_epoch_only) {
            // any of them may be the best
            (Some(_), _) => 1,
            (None, true) => request.training.epochs,
            (None, false) => request.training.epochs.div_ceil(KEPT_EPOCHS),
        },
        patience: request.patience,
        from: began_with,
        units: request.units,
        commit: request.commit.clone(),
        libtorch: LIBTORCH_VERSION.to_owned(),
        device: device.name().to_owned(),
    }
}

/// Early stopping needs something to measure epochs on.
fn ensure_patience(
    request: &TrainingRequest,
    fold: &Fold<'_>,
    rule: WindowRule,
) -> Result<(), DdlError> {
    let (validation, Some(patience)) = (request.validation, request.patience) else {
        return Ok(());
    };
    let measured = validation > 0.0 || !request.validation_recordings.is_empty();
    if patience == 0 || !measured {
        return Err(DdlError::Patience {
            patience,
            validation,
        });
    }
    if fold.training_split(rule, validation).validation.is_empty() {
        return Err(DdlError::NothingToValidateOn {
            recordings: fold.training_recordings().len() + fold.recordings_set_apart().len(),
        });
    }
    Ok(())
}

/// Evaluation runs the published estimator too, which needs as many tracks as it retrieves.
fn ensure_enough_tracks(goals: &GoalRecipe, windows: &[Window]) -> Result<(), DdlError> {
    let published = goals.retrieval.clone().into_published().check()?;
    let retrieval = goals.retrieval.clone().check()?;
    let (tracks, experts) = (
        windows.iter().map(Window::len).sum::<usize>(),
        match retrieval.frame() {
            RetrievalFrame::World => published.experts().max(retrieval.experts()),
            // a smaller library is used whole
            RetrievalFrame::Heading => published.experts(),
        },
    );
    if tracks < experts {
        return Err(DdlError::TooFewTracks { tracks, experts });
    }
    Ok(())
}

/// The training of the forecasting network: on single steps, or on walks to goals that those of the run estimate.
fn trainer(
    config: &RunConfig,
    windows: Vec<Window>,
    goals: &GoalModel,
    network: StarNetwork,
) -> Result<Trainer, DdlError> {
    let training = config.training.clone();
    Ok(match training.objective {
        Objective::NextStep => Trainer::new(network, windows, training)?,
        Objective::Walk => {
            let with_future: Vec<Window> = windows.into_iter().filter(Window::has_future).collect();
            let lessons = goals.lessons(&with_future)?;
            Trainer::towards(network, with_future, lessons, training)?
        }
    })
}

/// The model is chosen by the record: with a hole in it, it would be chosen among some of the epochs.
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
                "has no record of epoch {epoch} in metrics.jsonl, by which the best epoch is chosen; put the file back, or remove the directory and \
                 train anew"
            ),
        )),
    }
}

/// Trains to the end, saving what a later call needs to go on.
fn run_epochs(
    trainer: &mut Trainer,
    (run, origin): (&RunDirectory, &Origin),
    (keep_every, early_stopping): (usize, Option<&EarlyStopping>),
    mut observe: impl FnMut(&TrainingProgress) -> ControlFlow<()>,
) -> Result<(), DdlError> {
    let mut epochs = run.metrics()?;
    epochs.retain(|report| report.epoch <= trainer.completed_epochs());
    if let Some(stopping) = early_stopping
        && stopping.first_epoch() == 0
        && trainer.steps().0 == 0
    {
        // Before the first step the network is the one that it began with.
        save_parameters(trainer.network().parameters(), origin, &run.epoch(0))?;
        epochs = vec![EpochReport {
            epoch: 0,
            loss: 0.0,
            batches: 0,
            seconds: 0.0,
            validation: Some(stopping.min_ade(trainer.network())?),
        }];
        run.write_metrics(&epochs)?;
    }
    if let Some(stopping) = early_stopping {
        let measured = stopping.first_epoch()..=trainer.completed_epochs();
        ensure_every_epoch_is_recorded(&epochs, measured, run)?;
    }
    let mut saved = Instant::now();
    let is_over =
        |epochs: &[EpochReport]| early_stopping.is_some_and(|stopping| stopping.is_over(epochs));
    while !trainer.is_finished() && !is_over(&epochs) {
        let mut step = trainer.step()?;
        if let Some(epoch) = &mut step.finished_epoch {
            if let Some(stopping) = early_stopping {
                epoch.validation = Some(stopping.min_ade(trainer.network())?);
            }
            epochs.push(epoch.clone());
            if epoch.epoch % keep_every == 0 || trainer.is_finished() {
                save_parameters(
                    trainer.network().parameters(),
                    origin,
                    &run.epoch(epoch.epoch),
                )?;
            }
            run.write_metrics(&epochs)?;
        }
        let due = step.finished_epoch.is_some() || saved.elapsed() > SAVE_EVERY;
        let stop = observe(&TrainingProgress {
            steps: trainer.steps(),
            step: TrainingStep::Network(step),
        })
        .is_break();
        if due || stop {
            trainer.save(origin, &run.optimizer())?;
            saved = Instant::now();
        }
        if stop && !trainer.is_finished() && !is_over(&epochs) {
            return Err(DdlError::Interrupted);
        }
    }
    let parameters = trainer.network().parameters();
    if let Some(best) = best_epoch(&epochs) {
        // Read as any weights are, so that a file that was damaged since is named, before others are removed.
        load_parameters(parameters, origin, &run.best_epoch(best.epoch)?)?;
        run.remove_epochs_but(best.epoch)?;
    }
    // Last: with a model the run is finished, and nothing of this is done again.
    Ok(save_parameters(parameters, origin, &run.model())?)
}

/// Training uses every complete window of the convention.
pub(crate) fn training_rule(convention: Convention) -> WindowRule {
    match convention {
        Convention::SocialGan => WindowRule::SocialGan { min_pedestrians: 1 },
        _ => WindowRule::Complete,
    }
}

/// The fold of that name; of own recordings also the one that leaves none out ([`Fold::WHOLE`]).
///
/// # Errors
/// When there is none; the message lists those there are.
pub fn fold_of<'a>(dataset: &'a Dataset, name: &str) -> Result<Fold<'a>, DataError> {
    if dataset.convention() == Convention::Own && name == Fold::WHOLE {
        Ok(dataset.whole())
    } else {
        dataset.fold(name)
    }
}

/// The recordings that a fold trains or validates on.
fn learned_from<'a>(fold: &'a Fold<'_>) -> impl Iterator<Item = &'a Recording> {
    let learned = fold.training_recordings().iter();
    learned.chain(fold.recordings_set_apart()).copied()
}

/// SHA-256 of a recording's frames, people and positions; its name does not matter.
pub(crate) fn digest_of_recording(recording: &Recording) -> String {
    let mut hasher = Sha256::new();
    for seen in recording.observations() {
        hasher.update(seen.frame.to_le_bytes());
        hasher.update(seen.pedestrian.0.to_le_bytes());
        for coordinate in seen.position {
            hasher.update(coordinate.to_le_bytes());
        }
    }
    sha256::in_hex(hasher)
}

/// SHA-256 of the windows' positions.
pub(crate) fn digest(windows: &[Window]) -> String {
    let mut hasher = Sha256::new();
    for window in windows {
        hasher.update(window.recording().as_bytes());
        hasher.update(window.start_frame().to_le_bytes());
        for i in 0..window.len() {
            for coordinate in window.track(i).iter().flatten() {
                hasher.update(coordinate.to_le_bytes());
            }
        }
    }
    sha256::in_hex(hasher)
}
