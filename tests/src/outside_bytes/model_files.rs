//! The files of a model: a run's `config.json`, `metrics.jsonl` and safetensors files, and the packed model.

use std::cell::RefCell;
use std::collections::HashMap;
use std::path::Path;
use std::rc::Rc;

use ddl::star::{
    ComputeDevice, ProposalConfig, ProposalNetwork, StarConfig, StarNetwork, Trainer,
    TrainingConfig, load_parameters, numbers_digest, save_parameters, to_half,
};
use ddl::{
    BuiltinModel, Ddl, DeviceChoice, GoalModel, GoalRecipe, ModelSource, RunConfig, RunDirectory,
};
use ddl_data::{PedestrianId, Window};
use safetensors::tensor::{Dtype, TensorView};
use serde_json::Value;
use sha2::{Digest as _, Sha256};
use tempfile::TempDir;

use super::edits::Choices;
use crate::tiny_model::use_one_thread;

/// Smallest networks there are: what is fuzzed is the reading.
struct Small {
    config: RunConfig,
    network: StarNetwork,
    /// Half-precision tensors of both networks: names, shapes, bytes.
    halves: Vec<(String, Vec<usize>, Vec<u8>)>,
    folder: TempDir,
    run: RunDirectory,
    weights: Vec<u8>,
    experts: Vec<u8>,
    state: Vec<u8>,
    config_text: String,
}

// libtorch's tensors stay on their thread.
thread_local! {
    static SMALL: Rc<Small> = Rc::new(make().expect("the smallest model can be made"));
    static TRAINER: RefCell<Option<Trainer>> = const { RefCell::new(None) };
}

fn small() -> Rc<Small> {
    SMALL.with(Rc::clone)
}

fn window() -> Window {
    let walk = (0..20).map(|t| [0.5 * f64::from(t), 0.0]).collect();
    Window::new("yard", 0, 10, vec![PedestrianId(1)], vec![walk]).expect("a sound window")
}

fn trainer(config: &RunConfig) -> Trainer {
    let device = ComputeDevice::open(DeviceChoice::Cpu).expect("the CPU is always there");
    let network = StarNetwork::new(config.star.clone(), 1, device).expect("a sound configuration");
    let training = TrainingConfig {
        objective: ddl::star::Objective::NextStep,
        jitter: 0.0,
        epochs: 3,
        ..config.training.clone()
    };
    Trainer::new(network, vec![window()], training).expect("a window to train on")
}

fn make() -> Result<Small, Box<dyn std::error::Error>> {
    use_one_thread();
    let mut config = BuiltinModel::default().config()?;
    config.star = StarConfig {
        model_width: 2,
        heads: 1,
        feed_forward_width: 1,
        spatial_layers: 1,
        noise_width: 1,
        ..config.star
    };
    let mut recipe = GoalRecipe::proposed(1);
    if let Some(proposal) = &mut recipe.proposal {
        proposal.network = ProposalConfig {
            members: 1,
            ends: 2,
            width: 2,
            layers: 1,
            neighbour_width: 1,
            heads: 1,
            neighbours: 1,
            ..ProposalConfig::default()
        };
    }
    let proposal_config = recipe.proposal.clone().ok_or("proposed")?.network;
    config.goals = recipe;
    config.data.walkers = 2;
    let device = ComputeDevice::open(DeviceChoice::Cpu)?;
    let network = StarNetwork::new(config.star.clone(), 1, device)?;
    let proposal = ProposalNetwork::new(proposal_config, 1, device)?;
    let mut halves = Vec::new();
    for (head, parameters) in [
        ("network.", network.parameters()),
        ("proposal.", proposal.parameters()),
    ] {
        for tensor in to_half(parameters)? {
            halves.push((format!("{head}{}", tensor.name), tensor.shape, tensor.bytes));
        }
    }
    let folder = tempfile::tempdir()?;
    let here = |name: &str| folder.path().join(name);
    save_parameters(
        network.parameters(),
        &config.network_origin(),
        &here("weights"),
    )?;
    trainer(&config).save(&config.network_origin(), &here("state"))?;
    let mut retrieved = config.clone();
    retrieved.goals = GoalRecipe::retrieved(1);
    let positions: Vec<u8> = (0..2 * 20 * 2)
        .flat_map(|i| (0.25 * f64::from(i)).to_le_bytes())
        .collect();
    let view = TensorView::new(Dtype::F64, vec![2, 20, 2], &positions)?;
    let header = retrieved
        .goals_origin()
        .to_header(&numbers_digest([("tracks", view.clone())]));
    let experts = safetensors::serialize([("tracks", view)], Some(header))?;
    let run = RunDirectory::new(here("run"));
    std::fs::create_dir(run.path())?;
    let config_text = serde_json::to_string(&config)?;
    std::fs::write(
        run.path().join("config.json"),
        serde_json::to_string(&retrieved)?,
    )?;
    Ok(Small {
        weights: std::fs::read(here("weights"))?,
        state: std::fs::read(here("state"))?,
        experts,
        config,
        network,
        halves,
        run,
        config_text,
        folder,
    })
}

/// A file of weights as earlier versions wrote it, without the SHA-256 of its numbers: what lies behind that check is reached too.
fn without_digest(file: &[u8]) -> Vec<u8> {
    let (length, rest) = file.split_at(8);
    let length = u64::from_le_bytes(length.try_into().expect("eight bytes")) as usize;
    let (header, numbers) = rest.split_at(length);
    let mut header: Value = serde_json::from_slice(header).expect("a sound header");
    let origin = &mut header["__metadata__"]["origin"];
    let mut facts: Value = origin
        .as_str()
        .and_then(|facts| serde_json::from_str(facts).ok())
        .expect("a sound origin");
    let removed = facts
        .as_object_mut()
        .and_then(|facts| facts.remove("numbers.sha256"));
    assert!(removed.is_some(), "the file has a digest");
    *origin = facts.to_string().into();
    let mut header = header.to_string();
    while !header.len().is_multiple_of(8) {
        header.push(' ');
    }
    let length = (header.len() as u64).to_le_bytes();
    [&length[..], header.as_bytes(), numbers].concat()
}

/// Edits of a file of weights: of the file as it is, or of one without a digest, as the first byte says.
fn edited_weights(bytes: &[u8], whole: &[u8]) -> Vec<u8> {
    match bytes.split_first() {
        None => whole.to_vec(),
        Some((way, edits)) if way & 1 == 0 => edited(edits, whole),
        Some((_, edits)) => edited(edits, &without_digest(whole)),
    }
}

/// The bytes, or as many edits of `whole` as there are choices for.
fn edited(bytes: &[u8], whole: &[u8]) -> Vec<u8> {
    let mut edited = whole.to_vec();
    let mut choices = Choices::new(bytes);
    while !choices.is_empty() {
        choices.edit(&mut edited);
    }
    edited
}

fn names_file(error: &impl std::fmt::Display, name: &str) {
    assert!(error.to_string().contains(name), "{error}");
}

/// Writes a file and hands it to a reader.
fn with_file<T>(path: &Path, bytes: &[u8], read: impl FnOnce(&Path) -> T) -> T {
    std::fs::write(path, bytes).expect("the file can be written");
    read(path)
}

/// A packed model: bytes as they are, edits of a sound file, or of a part of it with the digest made anew.
///
/// # Panics
/// When a file is read that does not hold what its networks need, or the one without edits is refused.
pub fn read_packed(bytes: &[u8]) {
    let small = small();
    let (file, sound) = edited_packed(&small, bytes);
    let path = small.folder.path().join("packed.safetensors");
    match with_file(&path, &file, |path| Ddl::load(path, DeviceChoice::Cpu)) {
        Ok(model) => {
            let config = model.config();
            assert!(config.star.check().is_ok() && config.goals.check().is_ok());
        }
        Err(error) => {
            assert!(!sound, "a sound file: {error}");
            // Errors about the configuration's fields name those, all others the file.
            assert!(!error.to_string().is_empty());
        }
    }
}

/// The same without making the networks of a file that is whole, which is what takes time.
///
/// # Panics
/// When a file is refused without being named, or the one without edits is refused.
pub fn read_packed_config(bytes: &[u8]) {
    let small = small();
    let (file, sound) = edited_packed(&small, bytes);
    let path = small.folder.path().join("config-of-packed.safetensors");
    let read = with_file(&path, &file, |path| ModelSource::at(path).config());
    if let Err(error) = read {
        assert!(!sound, "a sound file: {error}");
        names_file(&error, "config-of-packed.safetensors");
    }
}

/// A packed file as the bytes say, and whether it is a sound one without edits.
fn edited_packed(small: &Small, bytes: &[u8]) -> (Vec<u8>, bool) {
    let mut choices = Choices::new(bytes);
    let way = choices.byte() % 4;
    let file = match way {
        0 => choices.rest().to_vec(),
        1 => edited(choices.rest(), &packed(&small.config_text, &small.halves)),
        2 => {
            let config = edited(choices.rest(), small.config_text.as_bytes());
            packed(&String::from_utf8_lossy(&config), &small.halves)
        }
        _ => {
            let mut halves = small.halves.clone();
            while !choices.is_empty() && !halves.is_empty() {
                forge(&mut halves, &mut choices);
            }
            packed(&small.config_text, &halves)
        }
    };
    (file, way > 0 && bytes.len() <= 1)
}

/// Another shape, name or content for one of the tensors.
fn forge(halves: &mut Vec<(String, Vec<usize>, Vec<u8>)>, choices: &mut Choices<'_>) {
    let index = choices.below(halves.len());
    match choices.byte() % 6 {
        0 => drop(halves.remove(index)),
        1 => {
            let mut twin = halves[index].clone();
            // The writer of such files takes each name once.
            while halves.iter().any(|(name, ..)| *name == twin.0) {
                twin.0.push('x');
            }
            halves.push(twin);
        }
        2 => halves[index].1.reverse(),
        3 => halves[index].1.push(choices.below(3)),
        4 => {
            let place = choices.below(halves[index].2.len());
            let new: [u8; 2] = choices.bytes();
            for (byte, new) in halves[index].2[place..].iter_mut().zip(new) {
                *byte = new;
            }
        }
        _ => {
            let size = choices.below(9);
            halves[index].1 = vec![size];
            halves[index].2 = vec![choices.byte(); 2 * size];
        }
    }
}

/// The file of a configuration and tensors, with their digest: the layout that `ddl pack` writes.
fn packed(config: &str, halves: &[(String, Vec<usize>, Vec<u8>)]) -> Vec<u8> {
    let mut by_name: Vec<_> = halves.iter().collect();
    by_name.sort_by(|one, other| one.0.cmp(&other.0));
    let mut hasher = Sha256::new();
    let mut part = |bytes: &[u8]| {
        hasher.update((bytes.len() as u64).to_le_bytes());
        hasher.update(bytes);
    };
    part(config.as_bytes());
    for (name, shape, bytes) in by_name {
        part(name.as_bytes());
        let shape: Vec<u8> = shape
            .iter()
            .flat_map(|&size| (size as u64).to_le_bytes())
            .collect();
        part(&shape);
        part(bytes);
    }
    let digits = |byte: &u8| {
        [byte >> 4, byte & 15].map(|digit| char::from(b"0123456789abcdef"[usize::from(digit)]))
    };
    let sha256: String = hasher.finalize().iter().flat_map(digits).collect();
    let entry = serde_json::json!({ "layout": 1, "config": config, "sha256": sha256 });
    let header = HashMap::from([("ddl".to_owned(), entry.to_string())]);
    let views = halves.iter().filter_map(|(name, shape, bytes)| {
        let view = TensorView::new(Dtype::F16, shape.clone(), bytes).ok()?;
        Some((name.as_str(), view))
    });
    safetensors::serialize(views, Some(header)).expect("the parts make a file")
}

/// `config.json`: bytes as they are, or edits of a sound one.
///
/// # Panics
/// When what is read reads otherwise once written.
pub fn read_config(bytes: &[u8]) {
    let small = small();
    let Some((&way, bytes)) = bytes.split_first() else {
        return;
    };
    let text = match way & 1 {
        0 => bytes.to_vec(),
        _ => edited(bytes, small.config_text.as_bytes()),
    };
    let run = RunDirectory::new(small.folder.path());
    let path = small.folder.path().join("config.json");
    match with_file(&path, &text, |_| run.config()) {
        Err(error) => names_file(&error, &small.folder.path().display().to_string()),
        Ok(config) => {
            let _ = (
                config.star.check(),
                config.goals.check(),
                config.training.check(),
            );
            let written = serde_json::to_string(&config).expect("what was read can be written");
            let again = with_file(&path, written.as_bytes(), |_| run.config());
            assert_eq!(again.ok(), Some(config));
        }
    }
}

/// `metrics.jsonl`.
///
/// # Panics
/// When an error does not name the file.
pub fn read_metrics(bytes: &[u8]) {
    let small = small();
    let run = RunDirectory::new(small.folder.path());
    let path = small.folder.path().join("metrics.jsonl");
    if let Err(error) = with_file(&path, bytes, |_| run.metrics()) {
        names_file(&error, "metrics.jsonl");
    }
}

/// The weights of a network: edits of a sound file.
///
/// # Panics
/// When an error changes the network, or what is read is no number.
pub fn read_weights(bytes: &[u8]) {
    let small = small();
    let file = edited_weights(bytes, &small.weights);
    let path = small.folder.path().join("model.safetensors");
    let (parameters, origin) = (small.network.parameters(), small.config.network_origin());
    let before = to_half(parameters).ok();
    let read = with_file(&path, &file, |path| {
        load_parameters(parameters, &origin, path)
    });
    if let Err(error) = read {
        names_file(&error, "model.safetensors");
        assert_eq!(to_half(parameters).ok(), before, "an error changes nothing");
    } else {
        assert!(bytes.len() > 1 || before == to_half(parameters).ok());
        let sound = with_file(&path, &small.weights, |path| {
            load_parameters(parameters, &origin, path)
        });
        sound.expect("the sound file is read");
    }
}

/// The expert library of a run: edits of a sound file.
///
/// # Panics
/// When the sound file is refused.
pub fn read_experts(bytes: &[u8]) {
    let small = small();
    let file = edited_weights(bytes, &small.experts);
    let read = with_file(&small.run.experts(), &file, |_| {
        GoalModel::load(small.run.path(), DeviceChoice::Cpu)
    });
    if let Err(error) = read {
        assert!(bytes.len() > 1, "a sound file: {error}");
    }
}

/// The state of a training under way: edits of a sound file.
///
/// # Panics
/// When a state is read that has more steps than the training.
pub fn read_training_state(bytes: &[u8]) {
    let small = small();
    let file = edited_weights(bytes, &small.state);
    let path = small.folder.path().join("optimizer.safetensors");
    TRAINER.with_borrow_mut(|kept| {
        let trainer = kept.get_or_insert_with(|| trainer(&small.config));
        let origin = small.config.network_origin();
        if let Err(error) = with_file(&path, &file, |path| trainer.resume(&origin, path)) {
            assert!(bytes.len() > 1, "a sound file: {error}");
            names_file(&error, "optimizer.safetensors");
        } else {
            let (steps, total) = trainer.steps();
            assert!(steps <= total);
        }
    });
}
