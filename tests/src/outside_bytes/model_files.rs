//! The files of a model: a run's `config.json`, `metrics.jsonl` and safetensors files, and the packed model. Their
//! networks are the smallest possible ones, because only the reading is tested.

#[cfg(test)]
mod forged;

use super::edits::edited;
use super::valid_file::{ValidFile, names_file, with_file};
use crate::{drawn_model, safetensors_file};
use arbitrary::Unstructured;
use ddl::network::weights::{Origin, Weights, in_hex, load_weights, save_weights};
use ddl::network::{ForecastWindows as _, MemoryConfig, MotionNetwork, ProposalConfig, StarConfig};
use ddl::{Ddl, DeviceChoice, GoalModel, GoalRecipe, ModelSource, RunConfig, RunDirectory, Variant};
use ddl_core::{PedestrianId, Window};
use serde_json::Value;
use sha2::{Digest as _, Sha256};
use std::path::Path;
use tempfile::TempDir;

/// The configuration of a run with the smallest networks, whose goals are proposed.
pub(super) fn smallest_config() -> RunConfig {
    let mut config = drawn_model::config(Variant::Full);
    config.star = StarConfig {
        model_width: 4,
        heads: 1,
        feed_forward_width: 1,
        spatial_layers: 1,
        noise_width: 1,
        ..config.star
    };
    if let Some(proposal) = &mut config.goals.proposal {
        proposal.network = ProposalConfig {
            members: 1,
            ends: 2,
            width: 2,
            layers: 1,
            neighbour_width: 1,
            heads: 1,
            neighbours: 1,
            memory: Some(MemoryConfig {
                remembered: 1,
                width: 1,
                heads: 1,
                hidden: 1,
                layers: 1,
                ..MemoryConfig::default()
            }),
            ..ProposalConfig::default()
        };
    }
    config.data.pedestrians = 2;
    config
}

/// The bytes themselves as `config.json`, or edits of a valid one; the first byte decides.
pub(super) fn run_config(bytes: &[u8]) {
    thread_local! {
        static VALID: (String, TempDir) = (
            serde_json::to_string(&smallest_config()).expect("a configuration can be written"),
            tempfile::tempdir().expect("a folder can be made"),
        );
    }
    let Some((&way, bytes)) = bytes.split_first() else {
        return;
    };
    VALID.with(|(valid, folder)| {
        let text = match way & 1 {
            0 => bytes.to_vec(),
            _ => edited(&mut Unstructured::new(bytes), valid.as_bytes()),
        };
        let run = RunDirectory::new(folder.path());
        let path = folder.path().join("config.json");
        match with_file(&path, &text, |_| run.config()) {
            Err(error) => names_file(&error, &folder.path().display().to_string()),
            Ok(config) => {
                let _ = (config.star.check(), config.goals.check(), config.training.check(config.star.variant));
                let written = serde_json::to_string(&config).expect("a valid configuration can be written");
                let again = with_file(&path, written.as_bytes(), |_| run.config());
                assert_eq!(again.ok(), Some(config));
            }
        }
    });
}

/// The bytes themselves as `metrics.jsonl`.
pub(super) fn metrics(bytes: &[u8]) {
    thread_local! {
        static FOLDER: TempDir = tempfile::tempdir().expect("a folder can be made");
    }
    FOLDER.with(|folder| {
        let run = RunDirectory::new(folder.path());
        let path = folder.path().join("metrics.jsonl");
        if let Err(error) = with_file(&path, bytes, |_| run.metrics()) {
            names_file(&error, "metrics.jsonl");
        }
    });
}

/// Edits of the weights of a network.
pub(super) fn weights(choices: &[u8]) {
    thread_local! {
        static VALID: ValidFile<(Weights, Origin)> = ValidFile::new("model.safetensors", without_digest, |path| {
            let config = smallest_config();
            let network = MotionNetwork::new(config.star.clone(), 1).expect("a valid configuration");
            let weights = network.copy_weights().expect("weights in memory");
            let origin = config.network_origin();
            save_weights(&weights, &origin, path).expect("weights can be written");
            (weights, origin)
        });
    }
    VALID.with(|valid| {
        let read = valid.read(choices, |(weights, origin), path| load_weights(weights.layout(), origin, path));
        if let Ok(weights) = read {
            assert!(weights.numbers().iter().all(|number| number.is_finite()));
            assert!(choices.len() > 1 || weights == valid.with.0);
        }
    });
}

/// Edits of the expert library of a run without proposed goals.
pub(super) fn experts(choices: &[u8]) {
    thread_local! {
        static VALID: ValidFile<()> = ValidFile::new("experts.safetensors", without_digest, |path| {
            let mut config = smallest_config();
            config.goals = GoalRecipe::retrieved(1);
            drawn_model::write(config, &[two_pedestrians()], path.parent().expect("the file lies in a run"));
        });
    }
    VALID.with(|valid| {
        drop(valid.read(choices, |(), path| {
            let run = path.parent().expect("the file lies in a run");
            GoalModel::open(&ModelSource::at(run), DeviceChoice::Cpu)
        }));
    });
}

fn two_pedestrians() -> Window {
    let walk = |y: f64| (0..20).map(|t| [0.5 * f64::from(t), y]).collect();
    let ids = [1, 2].map(PedestrianId).to_vec();
    Window::new("yard", 0, 10, ids, vec![walk(0.0), walk(1.0)]).expect("a window")
}

/// Writes the smallest packed model.
fn packed_example(path: &Path) {
    let run = tempfile::tempdir().expect("a folder can be made");
    drawn_model::write(smallest_config(), &[two_pedestrians()], run.path());
    let model = Ddl::load(run.path(), DeviceChoice::Cpu).expect("the run is complete");
    model.pack(path).expect("a model can be packed");
}

/// Edits of a packed model. The first byte chooses whether the networks are created as well, which takes most of the
/// time: in one of four cases.
pub(super) fn packed_model(choices: &[u8]) {
    thread_local! {
        static VALID: ValidFile<()> = ValidFile::new("packed.safetensors", with_digest, packed_example);
    }
    let Some((&first, choices)) = choices.split_first() else {
        return;
    };
    VALID.with(|valid| {
        if first % 4 == 0 {
            if let Ok(model) = valid.read(choices, |(), path| Ddl::load(path, DeviceChoice::Cpu)) {
                let config = model.config();
                assert!(config.star.check().is_ok() && config.goals.check().is_ok());
            }
        } else {
            drop(valid.read(choices, |(), path| ModelSource::at(path).config()));
        }
    });
}

/// The file in the layout of earlier versions, without the SHA-256 of its numbers.
pub(super) fn without_digest(file: &[u8]) -> Option<Vec<u8>> {
    let (mut header, numbers) = safetensors_file::parts(file).ok()?;
    let origin = header["__metadata__"]["origin"].as_str()?;
    let mut facts: Value = serde_json::from_str(origin).ok()?;
    facts.as_object_mut()?.remove("numbers.sha256")?;
    header["__metadata__"]["origin"] = facts.to_string().into();
    Some(safetensors_file::join(&header, numbers))
}

/// A packed model with the SHA-256 of its present contents.
fn with_digest(file: &[u8]) -> Option<Vec<u8>> {
    let (mut header, numbers) = safetensors_file::parts(file).ok()?;
    let mut entry: Value = serde_json::from_str(header["__metadata__"]["ddl"].as_str()?).ok()?;
    let mut hasher = Sha256::new();
    let mut part = |bytes: &[u8]| {
        hasher.update((bytes.len() as u64).to_le_bytes());
        hasher.update(bytes);
    };
    part(entry["config"].as_str()?.as_bytes());
    part(entry["motions"].as_str().unwrap_or_default().as_bytes());
    for (name, tensor) in header.as_object()? {
        if name != "__metadata__" {
            let shape: Vec<u64> = serde_json::from_value(tensor["shape"].clone()).ok()?;
            let [start, end]: [usize; 2] = serde_json::from_value(tensor["data_offsets"].clone()).ok()?;
            part(name.as_bytes());
            part(&shape.iter().flat_map(|size| size.to_le_bytes()).collect::<Vec<u8>>());
            part(numbers.get(start..end)?);
        }
    }
    *entry.get_mut("sha256")? = in_hex(hasher).into();
    header["__metadata__"]["ddl"] = entry.to_string().into();
    Some(safetensors_file::join(&header, numbers))
}
