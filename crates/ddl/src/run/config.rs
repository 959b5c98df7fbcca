use crate::goals::recipe::GoalRecipe;
use crate::run::starting_model::StartingModel;
use crate::run::track_units::TrackUnits;
use ddl_data::{Convention, WindowRule};
use ddl_network::weights::Origin;
use ddl_network::{Objective, StarConfig, TrainingConfig};
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::collections::BTreeMap;

/// Version of the run directory's layout.
pub const FORMAT: u32 = 8;

/// The part of `config.json` that every version of the layout has.
#[derive(Deserialize)]
pub(crate) struct ConfigFormat {
    pub(crate) format: u32,
}

/// Everything that decides what a run computes.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RunConfig {
    /// Version of the layout, [`FORMAT`].
    pub format: u32,
    /// The network.
    pub star: StarConfig,
    /// How it is trained.
    pub training: TrainingConfig,
    /// What the goals come from.
    pub goals: GoalRecipe,
    /// What it is trained on.
    pub data: TrainingData,
    /// Weights are kept after every so many epochs.
    pub keep_every: usize,
    /// Training ends early when the validation error has not fallen for so many epochs, and the best epoch is the model; `None`: all epochs,
    /// and the last is the model.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub patience: Option<usize>,
    /// The model whose weights both networks began with; `None`: random ones.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub from: Option<StartingModel>,
    /// What the numbers of own recordings mean, as far as training was told: they are measured on by the same, unless something else is said.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub units: Option<TrackUnits>,
    /// Commit of the program that began it, as far as known.
    pub commit: String,
    /// libtorch that it was begun with.
    pub libtorch: String,
    /// Device it was begun on; it may have gone on elsewhere.
    pub device: String,
}

impl RunConfig {
    /// What the weights of the forecasting network, and the state of its training, are of.
    #[must_use]
    pub fn network_origin(&self) -> Origin {
        match self.training.objective {
            Objective::NextStep => {
                self.origin_of(&["format", "star", "training", "data", "patience", "from"])
            }
            // Who has learned walks to the proposed goals has learned from these.
            Objective::Walk => self.origin_of(&[
                "format", "star", "training", "data", "goals", "patience", "from",
            ]),
        }
    }

    /// What the expert library and the proposal network are of.
    #[must_use]
    pub fn goals_origin(&self) -> Origin {
        self.origin_of(&["format", "goals", "data", "from"])
    }

    /// What the run is of: everything but commit, libtorch and device, which may change while it is trained, and units, which the windows show.
    #[must_use]
    pub fn origin(&self) -> Origin {
        self.origin_of(&[
            "format",
            "star",
            "training",
            "goals",
            "data",
            "keep_every",
            "patience",
            "from",
        ])
    }

    /// Some parts of `config.json`, each leaf under its path, such as `training.seed`.
    fn origin_of(&self, parts: &[&str]) -> Origin {
        let mut leaves = Vec::new();
        // Plain data always becomes JSON; what did not would agree with nothing that did.
        if let Ok(Value::Object(fields)) = serde_json::to_value(self) {
            for (name, value) in fields {
                if parts.contains(&name.as_str()) {
                    push_leaves(name, &value, &mut leaves);
                }
            }
        }
        leaves.into_iter().collect()
    }
}

/// The leaves of plain data, each under its path, which begins with `name`.
pub(crate) fn leaves(name: &str, data: &impl Serialize) -> Origin {
    let mut leaves = Vec::new();
    // Plain data always becomes JSON; what did not would agree with nothing that did.
    if let Ok(value) = serde_json::to_value(data) {
        push_leaves(name.to_owned(), &value, &mut leaves);
    }
    leaves.into_iter().collect()
}

fn push_leaves(path: String, value: &Value, leaves: &mut Vec<(String, String)>) {
    match value {
        Value::Object(fields) => {
            for (name, value) in fields {
                push_leaves(format!("{path}.{name}"), value, leaves);
            }
        }
        Value::String(text) => leaves.push((path, text.clone())),
        other => leaves.push((path, other.to_string())),
    }
}

/// What a run is trained on.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TrainingData {
    /// Data convention.
    pub convention: Convention,
    /// The fold whose test scene was left out.
    pub fold: String,
    /// Rule that cut the training windows.
    pub window_rule: WindowRule,
    /// Share of the training recordings' time, at their ends, kept for validation; 0 for none.
    pub validation: f64,
    /// Training recordings kept for validation whole.
    pub validation_recordings: Vec<String>,
    /// Training windows.
    pub windows: usize,
    /// Pedestrians in them, each counted once a window.
    pub pedestrians: usize,
    /// SHA-256 of their positions.
    pub sha256: String,
    /// The own recordings that were trained or validated on, by name, with the SHA-256 of their frames, people and positions: none of these names, and none of
    /// these contents under another name, is a test. Empty for recordings whose folds are known.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub recordings: BTreeMap<String, String>,
}

#[cfg(test)]
mod tests {
    use crate::BuiltinModel;

    #[test]
    fn the_origin_is_what_decides_the_numbers() {
        let first = BuiltinModel::default().config().unwrap();
        let mut other = first.clone();
        other.commit = "another".to_owned();
        assert_eq!(first.origin().difference(&other.origin()), None);
        other.training.seed += 1;
        assert_eq!(first.goals_origin().difference(&other.goals_origin()), None);
        let seeds = [&first, &other].map(|config| config.training.seed);
        assert_eq!(
            first.origin().difference(&other.origin()).unwrap(),
            format!("training.seed is {}, not {}", seeds[0], seeds[1])
        );
    }
}
