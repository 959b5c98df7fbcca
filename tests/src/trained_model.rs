//! Training of the networks of the [drawn model](crate::drawn_model) in this process, for a few seconds.

use crate::folder_contents::{self, Contents};
use crate::place::{Place, json};
use crate::{crowd, drawn_model};
use ddl::network::TrainingConfig;
use ddl::{DdlError, DeviceChoice, RunDirectory, TrainingProgress, TrainingRequest, TrainingStep, Variant};
use serde_json::Value;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, Once, OnceLock};
use std::time::{Duration, Instant};

/// libtorch has one random number generator, which parallel trainings would share.
static TRAINING: Mutex<()> = Mutex::new(());

/// Training pedestrians: enough to change every weight.
pub const PEDESTRIANS: usize = 96;
/// Pedestrians per batch: four batches.
pub const BATCH: usize = PEDESTRIANS / 4;

/// A training of a few seconds by the program: 12 steps of the proposal network, then 3 epochs of 8 steps.
pub const TRAIN: &str = "train --convention simulated --fold doorway --epochs 3 --train-pedestrians 128 \
                         --batch-pedestrians 16 --proposal-steps 12 --threads 1 --out run";

/// The reproducible files of [`TRAIN`], run once without a disturbance, and the time it takes.
pub fn undisturbed() -> &'static (Contents, Duration) {
    static FINISHED: OnceLock<(Contents, Duration)> = OnceLock::new();
    FINISHED.get_or_init(|| {
        let begun = Instant::now();
        (finish(&Place::empty()), begun.elapsed())
    })
}

/// Runs [`TRAIN`] to its end, and returns its reproducible files.
pub fn finish(place: &Place) -> Contents {
    let _ = place.ok(TRAIN);
    result(&place.at("run"))
}

/// The files of a run, byte for byte, except durations: of `metrics.jsonl` the losses are compared, and
/// `optimizer.safetensors`, which contains the model's weights, is left out.
pub fn result(run: &Path) -> Contents {
    let mut files = folder_contents::read(run);
    let metrics = files.remove(&PathBuf::from("metrics.jsonl")).flatten();
    let metrics = String::from_utf8(metrics.expect("there are metrics")).expect("JSON is text");
    let epochs: Vec<_> = metrics.lines().map(without_seconds).collect();
    files.insert(PathBuf::from("losses"), Some(epochs.concat().into_bytes()));
    files.remove(&PathBuf::from("optimizer.safetensors"));
    files
}

/// JSON without its durations, which vary.
pub fn without_seconds(text: &str) -> String {
    let mut value = json(text);
    forget_seconds(&mut value);
    value.to_string()
}

fn forget_seconds(value: &mut Value) {
    match value {
        Value::Object(fields) => {
            fields.retain(|name, _| !name.contains("seconds"));
            fields.values_mut().for_each(forget_seconds);
        }
        Value::Array(items) => items.iter_mut().for_each(forget_seconds),
        _ => {}
    }
}

/// Uses one thread for tensors in this process, because tests run in parallel already and the order of sums must be
/// fixed. Call it before the first tensor is created; it may be called again.
pub fn use_one_thread() {
    static PREPARED: Once = Once::new();
    PREPARED.call_once(|| {
        ddl::prepare(DeviceChoice::Cpu, Some(1)).expect("the CPU is always there");
    });
}

/// The files of a finished training run.
pub fn contents() -> &'static Contents {
    static TRAINED: OnceLock<Contents> = OnceLock::new();
    TRAINED.get_or_init(|| {
        let folder = tempfile::tempdir().expect("a temporary folder can be made");
        train(&RunDirectory::new(folder.path())).expect("training succeeds");
        folder_contents::read(folder.path())
    })
}

/// Trains, or resumes the training in the run's folder.
///
/// # Errors
/// The error that stops the training.
pub fn train(run: &RunDirectory) -> Result<(), DdlError> {
    train_until(run, |_| ControlFlow::Continue(()))
}

/// Starts a training that continues as long as its observer allows.
///
/// # Errors
/// The error that stops the training.
pub fn train_until(
    run: &RunDirectory,
    mut goes_on: impl FnMut(&TrainingStep) -> ControlFlow<()>,
) -> Result<(), DdlError> {
    use_one_thread();
    let _one_at_a_time = TRAINING.lock();
    let observe = |now: &TrainingProgress| goes_on(&now.step);
    ddl::train(&request(run.path()), crowd::dataset(), observe)
}

fn request(out: &Path) -> TrainingRequest {
    let config = drawn_model::config(Variant::Full);
    let mut request = TrainingRequest::recommended(config.data.fold, RunDirectory::new(out));
    request.star = config.star;
    request.training =
        TrainingConfig { pedestrians_per_epoch: Some(PEDESTRIANS), batch_pedestrians: BATCH, ..config.training };
    request.goals = config.goals;
    request.commit = config.commit;
    request
}
