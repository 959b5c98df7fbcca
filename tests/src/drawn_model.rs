//! A run with random weights: a model of every variant without training.

use crate::crowd;
use crate::folder_contents::{self, Contents};
use ddl::data::{Convention, Window, WindowRule};
use ddl::network::weights::{save_weights, tensors_digest};
use ddl::network::{
    EpochReport, ForecastWindows as _, MemoryConfig, MotionNetwork, ProposalConfig, ProposalNetwork,
    ProposeEndpoints as _, StarConfig, TrainingConfig,
};
use ddl::{Ddl, DeviceChoice, FORMAT, GoalRecipe, RunConfig, TrainingData, Variant};
use safetensors::tensor::{Dtype, TensorView};
use std::collections::BTreeMap;
use std::path::Path;
use std::sync::OnceLock;

/// One in this many training windows is used, which gives a small and fast library.
const STRIDE: usize = 10;

/// A model of a variant, loaded from its run.
pub fn of(variant: Variant) -> Ddl {
    let folder = tempfile::tempdir().expect("a temporary folder can be made");
    folder_contents::write(contents(variant), folder.path());
    Ddl::load(folder.path(), DeviceChoice::Cpu).expect("the drawn model loads")
}

/// The files of a model's run, the same at every call.
pub fn contents(variant: Variant) -> &'static Contents {
    static DRAWN: [OnceLock<Contents>; 4] = [const { OnceLock::new() }; 4];
    let index = Variant::ALL.iter().position(|&listed| listed == variant);
    DRAWN[index.expect("ALL holds every variant")].get_or_init(|| {
        let folder = tempfile::tempdir().expect("a temporary folder can be made");
        let windows = crowd::training_windows().into_iter().step_by(STRIDE);
        write(config(variant), &windows.collect::<Vec<_>>(), folder.path());
        folder_contents::read(folder.path())
    })
}

/// The configuration of the run: the recommended recipe, simulated crowds, small networks for goals.
pub fn config(variant: Variant) -> RunConfig {
    let training = TrainingConfig { epochs: 1, ..TrainingConfig::recommended(variant) };
    RunConfig {
        format: FORMAT,
        star: StarConfig::recommended(variant),
        goals: goal_recipe(training.seed),
        training,
        data: TrainingData {
            convention: Convention::Simulated,
            fold: crowd::FOLD.to_owned(),
            window_rule: WindowRule::Complete,
            validation: 0.0,
            validation_recordings: Vec::new(),
            windows: 0,
            pedestrians: 0,
            sha256: "of no training".to_owned(),
            recordings: BTreeMap::new(),
        },
        keep_every: 1,
        patience: None,
        from: None,
        units: None,
        commit: "of the tests".to_owned(),
        libtorch: "none".to_owned(),
        device: "cpu".to_owned(),
    }
}

/// Goals proposed by two small networks, for a training of a few steps.
pub fn goal_recipe(seed: u64) -> GoalRecipe {
    let mut recipe = GoalRecipe::proposed(seed);
    if let Some(proposal) = &mut recipe.proposal {
        proposal.network = ProposalConfig {
            members: 2,
            width: 24,
            neighbour_width: 16,
            memory: Some(MemoryConfig { width: 16, ..MemoryConfig::default() }),
            ..ProposalConfig::default()
        };
        proposal.training.steps = 20;
        proposal.training.memory.steps = 10;
        proposal.training.batch = 32;
    }
    recipe
}

/// Writes the files of a trained run, with random weights; the pedestrians of the windows are its experts.
pub fn write(mut config: RunConfig, windows: &[Window], folder: &Path) {
    config.data.windows = windows.len();
    config.data.pedestrians = windows.iter().map(Window::len).sum();
    std::fs::create_dir_all(folder.join("epochs")).expect("a folder can be made");
    let network = MotionNetwork::new(config.star.clone(), config.training.seed).expect("the configuration is valid");
    let weights = network.copy_weights().expect("weights in memory");
    let origin = config.network_origin();
    for file in ["epochs/001.safetensors", "model.safetensors"] {
        save_weights(&weights, &origin, &folder.join(file)).expect("weights can be written");
    }
    if let Some(recipe) = config.goals.proposal.clone() {
        let proposal = ProposalNetwork::new(recipe.network, recipe.training.seed);
        let proposal = proposal.expect("the configuration is valid");
        let weights = proposal.copy_weights().expect("weights in memory");
        let file = folder.join("proposal.safetensors");
        save_weights(&weights, &config.goals_origin(), &file).expect("weights can be written");
    }
    let tracks = windows.iter().flat_map(|window| (0..window.len()).map(|i| window.track(i)));
    let positions: Vec<f64> = tracks.flatten().flatten().copied().collect();
    let epoch = EpochReport { epoch: 1, loss: 1.0, batches: 4, seconds: 1.0, validation: None };
    for (file, bytes) in [
        (folder.join("experts.safetensors"), experts(&config, &positions)),
        // It was trained on no recording.
        (folder.join("fingerprints.bin"), vec![1, 0, 0, 0]),
        (folder.join("config.json"), json(&config)),
        (folder.join("metrics.jsonl"), json(&epoch)),
    ] {
        std::fs::write(file, bytes).expect("a file can be written");
    }
}

fn json(data: &impl serde::Serialize) -> Vec<u8> {
    serde_json::to_vec(data).expect("plain data is JSON")
}

/// The file of an expert library: x and y of the 20 positions of each track, one track after the other.
fn experts(config: &RunConfig, positions: &[f64]) -> Vec<u8> {
    let bytes: Vec<u8> = positions.iter().flat_map(|x| x.to_le_bytes()).collect();
    let shape = vec![positions.len() / 40, 20, 2];
    let tracks = TensorView::new(Dtype::F64, shape, &bytes).expect("the tracks are complete");
    let digest = tensors_digest([("tracks", tracks.clone())]);
    let header = config.goals_origin().to_header(&digest);
    safetensors::serialize([("tracks", tracks)], Some(header)).expect("the parts make a file")
}
