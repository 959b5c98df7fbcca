//! A model of the recommended recipe, trained in seconds on the simulated crowds, once for a whole test binary.

use crate::crowd;
use crate::folder_contents::{self, Contents};
use crate::own_tracks;
use ddl::data::Dataset;
use ddl::network::{ProposalConfig, StarConfig, TrainingConfig};
use ddl::{
    Ddl, DdlError, DeviceChoice, GoalRecipe, RunDirectory, TrainingRequest, TrainingStage,
    TrainingStep, Variant,
};
use std::ops::ControlFlow;
use std::path::Path;
use std::sync::{Mutex, Once, OnceLock};
use tempfile::TempDir;

/// libtorch has one generator of random numbers: runs side by side would draw from each other's.
static TRAINING: Mutex<()> = Mutex::new(());

/// Walkers it is trained on: enough for every weight to have moved.
pub const WALKERS: usize = 96;

/// A model in a folder of its own, which a test may damage.
#[derive(Debug)]
pub struct TinyModel {
    /// The model, loaded from the folder.
    pub model: Ddl,
    folder: TempDir,
}

impl TinyModel {
    /// The folder of the run.
    #[must_use]
    pub fn folder(&self) -> &Path {
        self.folder.path()
    }
}

/// A copy of the tiny model of a variant; the first call of a variant trains it.
///
/// # Panics
/// If it cannot be trained, written or loaded.
#[must_use]
pub fn of(variant: Variant) -> TinyModel {
    let folder = folder(variant);
    let model = Ddl::load(folder.path(), DeviceChoice::Cpu).expect("the tiny model loads");
    TinyModel { model, folder }
}

/// A copy of the tiny model's folder alone.
///
/// # Panics
/// If it cannot be trained or written.
#[must_use]
pub fn folder(variant: Variant) -> TempDir {
    static TRAINED: [OnceLock<Contents>; 4] = [const { OnceLock::new() }; 4];
    use_one_thread();
    let index = Variant::ALL
        .iter()
        .position(|&known| known == variant)
        .expect("ALL holds every variant");
    let contents = TRAINED[index].get_or_init(|| trained(variant));
    let folder = tempfile::tempdir().expect("a temporary folder can be made");
    folder_contents::write(contents, folder.path());
    folder
}

/// A folder with tracks of three people and, in `run`, a copy of the tiny model.
///
/// # Panics
/// If it cannot be trained or written.
#[must_use]
pub fn folder_with_model() -> TempDir {
    let place = tempfile::tempdir().expect("a temporary folder can be made");
    let run = folder_contents::read(folder(Variant::Full).path());
    folder_contents::write(&run, &place.path().join("run"));
    let tracks = own_tracks::csv(&own_tracks::three_people(9));
    std::fs::write(place.path().join("tracks.csv"), tracks).expect("a csv can be written");
    place
}

/// One thread for tensors in this process, where tests run side by side already: sums are then in one
/// order. To be called before the first tensor is made; may be called again.
///
/// # Panics
/// Never: the CPU is always there.
pub fn use_one_thread() {
    static PREPARED: Once = Once::new();
    PREPARED.call_once(|| {
        ddl::prepare(DeviceChoice::Cpu, Some(1)).expect("the CPU is always there");
    });
}

/// Trains in this process, one run at a time.
///
/// # Panics
/// If training fails.
pub fn train(request: &TrainingRequest, dataset: &Dataset) {
    use_one_thread();
    let _one_at_a_time = TRAINING.lock();
    ddl::train(request, dataset, |_| ControlFlow::Continue(())).expect("training succeeds");
}

/// Runs the training of the tiny model's folder again, wherever it lies.
///
/// # Errors
/// What stops the training.
pub fn train_again(run: &RunDirectory) -> Result<(), DdlError> {
    use_one_thread();
    let _one_at_a_time = TRAINING.lock();
    let request = request(crowd::FOLD, Variant::Full, WALKERS, run.path());
    ddl::train(&request, &crowd::dataset(), |_| ControlFlow::Continue(()))
}

/// Begins the training of the tiny model anywhere, as long as its observer lets it go on.
///
/// # Errors
/// What stops the training.
pub fn train_until(
    run: &RunDirectory,
    mut goes_on: impl FnMut(&TrainingStep) -> ControlFlow<()>,
) -> Result<(), DdlError> {
    use_one_thread();
    let _one_at_a_time = TRAINING.lock();
    let request = request(crowd::FOLD, Variant::Full, WALKERS, run.path());
    ddl::train(&request, &crowd::dataset(), |now| goes_on(&now.step))
}

/// Walkers a batch when `walkers` are trained on: four batches.
#[must_use]
pub fn batch_walkers(walkers: usize) -> usize {
    walkers / 4
}

/// What is trained: one epoch of `walkers` walkers, all else as recommended.
#[must_use]
pub fn request(fold: &str, variant: Variant, walkers: usize, out: &Path) -> TrainingRequest {
    let training = TrainingConfig {
        epochs: 1,
        walkers_per_epoch: Some(walkers),
        batch_walkers: batch_walkers(walkers),
        ..TrainingConfig::recommended(variant)
    };
    TrainingRequest {
        fold: fold.to_owned(),
        star: StarConfig::recommended(variant),
        goals: goal_recipe(training.seed),
        training,
        validation: 0.0,
        validation_recordings: Vec::new(),
        patience: None,
        from: None,
        units: None,
        last_epoch_only: false,
        until: TrainingStage::Network,
        out: RunDirectory::new(out),
        device: DeviceChoice::Cpu,
        commit: "of the tests".to_owned(),
    }
}

/// Goals proposed by two small networks, a few steps old.
#[must_use]
pub fn goal_recipe(seed: u64) -> GoalRecipe {
    let mut recipe = GoalRecipe::proposed(seed);
    if let Some(proposal) = &mut recipe.proposal {
        proposal.network = ProposalConfig {
            members: 2,
            width: 24,
            neighbour_width: 16,
            ..ProposalConfig::default()
        };
        proposal.training.steps = 20;
        proposal.training.batch = 32;
    }
    recipe
}

/// Trains and keeps the files in memory: a folder in a static would never be removed.
fn trained(variant: Variant) -> Contents {
    let folder = tempfile::tempdir().expect("a temporary folder can be made");
    train(
        &request(crowd::FOLD, variant, WALKERS, folder.path()),
        &crowd::dataset(),
    );
    folder_contents::read(folder.path())
}
