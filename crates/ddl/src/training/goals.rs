//! The first stage of a training: the goals.

use crate::error::DdlError;
use crate::goals::experts;
use crate::goals::remembering::remembering;
use crate::goals::views;
use crate::run::directory::{RunDirectory, SAVE_EVERY};
use crate::run::goal_recipe::ProposalRecipe;
use ddl_core::{Window, WorkDone};
use ddl_data::Recording;
use ddl_goal::GoalError;
use ddl_memory::Playback;
use ddl_network::ProposalStep;
use ddl_network::weights::{Origin, Weights, save_weights};
use ddl_star::{ComputeDevice, ProposalTrainer, TorchProposals};
use std::ops::ControlFlow;
use std::time::Instant;

/// The first stage of a run.
#[derive(Debug)]
pub(crate) struct GoalStage<'a> {
    pub(crate) recipe: Option<&'a ProposalRecipe>,
    pub(crate) run: &'a RunDirectory,
    pub(crate) origin: Origin,
    pub(crate) device: ComputeDevice,
}

/// Writes the expert library and trains the proposal network. Files that already exist are kept. Training starts from
/// the weights of `start` if given; `choose` then selects the network to keep.
pub(crate) fn train(
    stage: &GoalStage<'_>,
    windows: &[Window],
    recordings: &[&Recording],
    start: Option<Weights>,
    choose: impl FnOnce(Weights) -> Result<Weights, DdlError>,
    mut observe: impl FnMut(WorkDone, &ProposalStep) -> ControlFlow<()>,
) -> Result<(), DdlError> {
    let (run, origin, device) = (stage.run, &stage.origin, stage.device);
    if !run.experts().is_file() {
        experts::save(&experts::library(windows)?, origin, &run.experts())?;
    }
    let Some(recipe) = stage.recipe.filter(|_| !run.proposal().is_file()) else {
        return Ok(());
    };
    let network = &recipe.network;
    let seen = |windows: Vec<Window>, playback: Playback| {
        let windows = match &network.memory {
            Some(memory) => {
                let nothing = |_: &str| Vec::new();
                remembering(recordings, &windows, nothing, Some(playback), memory.remembered)?
            }
            None => windows,
        };
        let examples = views::examples(&windows, network.neighbours, network.time_step);
        Ok::<_, DdlError>(examples.map_err(GoalError::from)?)
    };
    let whole = windows.iter().filter(|window| window.has_future());
    let reversed = whole.clone().map(Window::reversed).collect();
    let examples = seen(whole.cloned().collect(), Playback::Forward)?;
    let reversed = seen(reversed, Playback::Backward)?;
    let network = TorchProposals::new(recipe.network.clone(), recipe.training.seed, device)?;
    if let Some(start) = start {
        network.parameters().set(&start)?;
    }
    let mut trainer = ProposalTrainer::new(network, &examples, &reversed, recipe.training.clone())?;
    drop((examples, reversed));
    let state = run.proposal_state();
    if state.is_file() {
        trainer.resume(origin, &state)?;
    }
    let mut saved = Instant::now();
    while !trainer.is_finished() {
        let step = trainer.step()?;
        let stop = observe(trainer.steps(), &step).is_break();
        if stop || saved.elapsed() > SAVE_EVERY {
            trainer.save(origin, &state)?;
            saved = Instant::now();
        }
        if stop {
            return Err(DdlError::Interrupted);
        }
    }
    let weights = choose(trainer.into_network()?.parameters().to_weights()?)?;
    save_weights(&weights, origin, &run.proposal())?;
    // The state is no longer needed; failing to remove it is harmless.
    let _ = std::fs::remove_file(&state);
    Ok(())
}
