//! A run that was hardly trained: everything is there, of the published sizes, and costs what it costs.

use crate::Result;
use ddl::data::Dataset;
use ddl::network::weights::save_weights;
use ddl::network::{MotionNetwork, StarConfig, TrainingConfig};
use ddl::{
    DeviceChoice, GoalRecipe, RunConfig, RunDirectory, TrainingRequest, TrainingStage, Variant,
};
use std::ops::ControlFlow;
use std::path::Path;

pub(crate) fn run(dataset: &Dataset, folder: &Path) -> Result<RunDirectory> {
    let run = RunDirectory::new(folder.join("run"));
    let mut goals = GoalRecipe::proposed(1);
    if let Some(proposal) = &mut goals.proposal {
        proposal.training.steps = 1;
    }
    let request = TrainingRequest {
        fold: "corridor".to_owned(),
        star: StarConfig::published(Variant::Full),
        training: TrainingConfig {
            epochs: 1,
            batch_walkers: 1,
            walkers_per_epoch: Some(1),
            ..TrainingConfig::published()
        },
        validation: 0.0,
        validation_recordings: Vec::new(),
        goals,
        patience: None,
        from: None,
        units: None,
        last_epoch_only: false,
        until: TrainingStage::Network,
        out: run.clone(),
        device: DeviceChoice::Cpu,
        commit: "unknown".to_owned(),
    };
    ddl::train(&request, dataset, |_| ControlFlow::Continue(()))?;
    Ok(run)
}

/// Gives the run a forecasting network with feed-forward blocks of another width, with initial weights.
pub(crate) fn widen(run: &RunDirectory, feed_forward_width: i64) -> Result<()> {
    let mut config: RunConfig = run.config()?;
    config.star.feed_forward_width = feed_forward_width;
    let network = MotionNetwork::new(config.star.clone(), 1)?;
    save_weights(network.weights(), &config.network_origin(), &run.model())?;
    let text = serde_json::to_string_pretty(&config)?;
    Ok(ddl::write_atomically(
        &run.path().join("config.json"),
        text.as_bytes(),
    )?)
}
