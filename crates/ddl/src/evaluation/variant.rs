//! The variants of a model that an evaluation compares, each with its goals and its motion.

use crate::model::ddl::Ddl;
use ddl_eval::Protocol;
use ddl_network::{Objective, StepRule};

/// A way in which the model forecasts. Each has its own row of results.
#[derive(Debug)]
pub(crate) struct EvaluationVariant {
    pub(crate) goals: GivenGoals,
    pub(crate) motion: VariantMotion,
    /// The difference from the unchanged model; `None` for the unchanged model.
    pub(crate) change: Option<String>,
    pub(crate) protocol: Protocol,
}

/// The goals that the model receives.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum GivenGoals {
    Own,
    /// The central goal, which represents the model's own goals.
    Central,
    WithoutLibrary,
    /// Goals without the memory of training recordings of the same place.
    WithoutMemory,
    /// Goals of the published estimator, without its look at the first future frame.
    Published,
}

/// How the pedestrians move to the goals.
#[derive(Debug, Clone, Copy)]
pub(crate) enum VariantMotion {
    /// The motion that the network shapes.
    Shaped(StepRule),
    /// The neutral motion.
    Neutral,
    /// The model's futures of the whole scene, to their goals.
    Scenes,
}

/// Describes the memory under a protocol. The text is the same for all folds of a convention, because they share a line
/// of the table.
pub(crate) fn memory_words(protocol: Protocol, model: &Ddl) -> String {
    let folds: Vec<&str> = model.config().data.convention.folds_with_place_memory().collect();
    let of_place = format!("training recordings of the same place (folds {})", folds.join(", "));
    match (protocol.gives_recording_memory(), folds.is_empty()) {
        _ if model.goal_model().memory().is_none() => String::new(),
        (false, true) => String::new(),
        (false, false) => format!(", with a memory of {of_place}"),
        (true, true) => ", with a memory of the recording until then".to_owned(),
        (true, false) => format!(", with a memory of the recording until then and of {of_place}"),
    }
}

impl EvaluationVariant {
    pub(crate) fn goal_words(&self, model: &Ddl) -> String {
        let goals = model.goal_model();
        let words = match self.goals {
            // The name of the row already states the published goals.
            GivenGoals::Own | GivenGoals::Central | GivenGoals::Published | GivenGoals::WithoutMemory => goals.words(),
            GivenGoals::WithoutLibrary => goals.recipe().description_without_library(),
        };
        match self.goals {
            GivenGoals::WithoutMemory | GivenGoals::Published => words,
            _ => words + &memory_words(self.protocol, model),
        }
    }

    /// The unchanged model, and further variants once each: with plain Euler steps, without the expert library, with
    /// the published goals, and, under `single`, with the dynamics of the network.
    pub(crate) fn all(model: &Ddl, asked: &[Protocol]) -> Vec<Self> {
        let network = model.config().star.variant;
        let mut variants = Vec::new();
        let mut add = |protocol: Protocol, goals: GivenGoals, motion: VariantMotion, change: Option<String>| {
            if asked.contains(&protocol) {
                variants.push(Self { goals, motion, change, protocol });
            }
        };
        let stable = VariantMotion::Shaped(StepRule::Bounded);
        for protocol in [Protocol::Fair, Protocol::Online] {
            add(protocol, GivenGoals::Own, stable, None);
        }
        for protocol in [Protocol::Single, Protocol::OnlineSingle] {
            add(protocol, GivenGoals::Central, VariantMotion::Neutral, None);
        }
        let said = |change: &str| Some(change.to_owned());
        add(Protocol::Joint, GivenGoals::Own, VariantMotion::Scenes, None);
        let change = said("with its hypotheses by weight, as one future each");
        add(Protocol::Joint, GivenGoals::Own, stable, change);
        // Plain steps diverge for a network that was trained on whole paths of the stable steps.
        let learned_on_plain_steps = model.config().training.objective == Objective::NextStep;
        if network.dynamics() && learned_on_plain_steps {
            let plain = VariantMotion::Shaped(StepRule::Euler);
            add(Protocol::Fair, GivenGoals::Own, plain, said("with plain Euler steps"));
        }
        if network.uses_goal() {
            let change = said("on the way that its network shapes");
            add(Protocol::Single, GivenGoals::Central, stable, change);
            if model.goal_model().has_library_beside_network() {
                add(Protocol::Fair, GivenGoals::WithoutLibrary, stable, said("as packed"));
            }
            let mut with_memory = model.config().data.convention.folds_with_place_memory();
            if model.goal_model().memory().is_some() && with_memory.next().is_some() {
                let change = said("without a memory of the place");
                add(Protocol::Fair, GivenGoals::WithoutMemory, stable, change);
            }
            if asked.contains(&Protocol::Published) {
                let change = said("with the published goals, all 20 kept");
                add(Protocol::Fair, GivenGoals::Published, stable, change);
            }
        }
        variants
    }
}
