//! The configuration of a run, its `config.json`.

use crate::run::goal_recipe::GoalRecipe;
use crate::run::starting_model::InitialModel;
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

/// Everything that determines the result of a run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RunConfig {
    /// Version of the layout, [`FORMAT`].
    pub format: u32,
    /// The network.
    pub star: StarConfig,
    /// The training of the network.
    pub training: TrainingConfig,
    /// The origin of the goals.
    pub goals: GoalRecipe,
    /// The training data.
    pub data: TrainingData,
    /// Weights are saved after every `keep_every` epochs.
    pub keep_every: usize,
    /// Training ends early when the validation error has not fallen for this many epochs, and the best epoch becomes
    /// the model. `None`: train all epochs, and the last becomes the model.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub patience: Option<usize>,
    /// The model whose weights both networks started with; `None`: random weights.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub from: Option<InitialModel>,
    /// The units of own recordings as given to training. Evaluation uses the same units by default.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub units: Option<TrackUnits>,
    /// Commit of the program that began the run, if known.
    pub commit: String,
    /// Version of libtorch that began the run.
    pub libtorch: String,
    /// Device that began the run; it may have continued on another.
    pub device: String,
}

impl RunConfig {
    /// The settings that the weights and training state of the forecasting network depend on.
    #[must_use]
    pub fn network_origin(&self) -> Origin {
        match self.training.objective {
            Objective::NextStep => self.origin_of(&["format", "star", "training", "data", "patience", "from"]),
            // Training on whole paths uses the proposed goals, so it depends on their settings.
            Objective::Walk => self.origin_of(&["format", "star", "training", "data", "goals", "patience", "from"]),
        }
    }

    /// The settings that the expert library and the proposal network depend on.
    #[must_use]
    pub fn goals_origin(&self) -> Origin {
        self.origin_of(&["format", "goals", "data", "from"])
    }

    /// The settings that identify the run: all except commit, libtorch and device, which may change during training,
    /// and units, which show in the windows.
    #[must_use]
    pub(crate) fn origin(&self) -> Origin {
        self.origin_of(&["format", "star", "training", "goals", "data", "keep_every", "patience", "from"])
    }

    /// Some parts of `config.json`, each leaf with its path, such as `training.seed`.
    fn origin_of(&self, parts: &[&str]) -> Origin {
        let mut leaves = Vec::new();
        // Plain data always converts to JSON. An empty origin would match no file.
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

/// The leaves of plain data, each with its path, which begins with `name`.
pub(crate) fn leaves(name: &str, data: &impl Serialize) -> Origin {
    let mut leaves = Vec::new();
    // Plain data always converts to JSON. An empty origin would match no file.
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

/// The training data of a run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TrainingData {
    /// The data convention.
    pub convention: Convention,
    /// The fold whose test scene was left out.
    pub fold: String,
    /// The rule that cut the training windows.
    pub window_rule: WindowRule,
    /// Share of the training recordings' time, at their ends, kept for validation; 0 for none.
    pub validation: f64,
    /// Training recordings kept for validation as a whole.
    pub validation_recordings: Vec<String>,
    /// Training windows.
    pub windows: usize,
    /// Pedestrians in them, each counted once for each window.
    pub pedestrians: usize,
    /// SHA-256 of their positions.
    pub sha256: String,
    /// The own recordings that were trained or validated on: their names, each with the SHA-256 of its frames,
    /// pedestrians and positions. A recording with these contents is not a test. Empty for recordings with fixed
    /// folds.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub recordings: BTreeMap<String, String>,
}

#[cfg(test)]
mod tests {
    use crate::run::builtin_model::BuiltinModel;
    use crate::run::model_source::ModelSource;

    #[test]
    fn the_origin_holds_the_settings_that_determine_the_numbers() {
        let first = ModelSource::Builtin(BuiltinModel::default()).config().unwrap();
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
