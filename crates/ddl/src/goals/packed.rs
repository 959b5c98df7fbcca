//! A model in one small safetensors file. It holds the learned tensors of both networks in half precision, each
//! prefixed by the name of its network, and hashes of the motions that it was trained on. One entry of the header holds
//! the `config.json` of the run and a SHA-256 of the contents. The expert library is trajectory data and is not packed.

use crate::device::Device;
use crate::error::DdlError;
use crate::run::config::{ConfigFormat, FORMAT, RunConfig};
use crate::run::model_source::ModelSource;
use crate::trust::familiarity::TrainingMotions;
use crate::trust::fingerprints::TrackFingerprints;
use ddl_network::weights::{HalfTensor, Weights, in_hex};
use ddl_network::{ForecastWindows, NetworkError, ProposeEndpoints};
use safetensors::SafeTensors;
use safetensors::tensor::{Dtype, TensorView};
use serde::{Deserialize, Serialize};
use sha2::{Digest as _, Sha256};
use std::borrow::Cow;
use std::io::Read as _;
use std::path::Path;

/// Version of the file's layout.
pub(crate) const LAYOUT: u32 = 4;
pub(crate) const ENTRY: &str = "ddl";
/// Prefix of the names of the forecasting network's tensors.
pub(crate) const NETWORK: &str = "network.";
/// Prefix of the names of the proposal network's tensors.
pub(crate) const PROPOSAL: &str = "proposal.";
/// Name of the bytes of the fingerprints.
pub(crate) const FINGERPRINTS: &str = "fingerprints";
/// More than any realistic network takes.
const MOST_BYTES: u64 = 1 << 28;

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct PackedHeader {
    pub(crate) layout: u32,
    /// The run's `config.json` as a string, so that its digest does not depend on JSON formatting.
    pub(crate) config: String,
    /// The training motions that familiarity is measured against, as JSON.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) motions: Option<String>,
    pub(crate) sha256: String,
}

pub(crate) struct Unpacked {
    pub(crate) config: RunConfig,
    pub(crate) network: Box<dyn ForecastWindows>,
    pub(crate) proposal: Box<dyn ProposeEndpoints>,
    pub(crate) motions: Option<TrainingMotions>,
    pub(crate) fingerprints: TrackFingerprints,
}

pub(crate) fn bytes(source: &ModelSource) -> Result<Cow<'static, [u8]>, DdlError> {
    match source {
        ModelSource::Builtin(model) => Ok(Cow::Borrowed(model.bytes())),
        ModelSource::Packed(path) => read(path).map(Cow::Owned),
        ModelSource::Run(_) => Err(source.wrong("is the directory of a run, not a packed model")),
    }
}

fn read(path: &Path) -> Result<Vec<u8>, DdlError> {
    let io = |error| DdlError::io(path, error);
    let file = std::fs::File::open(path).map_err(io)?;
    let mut bytes = Vec::new();
    file.take(MOST_BYTES + 1).read_to_end(&mut bytes).map_err(io)?;
    if bytes.len() as u64 > MOST_BYTES {
        let problem = format!("is longer than {MOST_BYTES} bytes, the limit of a packed model");
        return Err(ModelSource::Packed(path.to_owned()).wrong(problem));
    }
    Ok(bytes)
}

/// A packed model whose networks are not made yet.
pub(crate) struct PackedContents {
    pub(crate) config: RunConfig,
    pub(crate) motions: Option<TrainingMotions>,
    pub(crate) fingerprints: TrackFingerprints,
    tensors: Vec<HalfTensor>,
}

/// What a packed model holds, after its digest is checked.
pub(crate) fn contents(bytes: &[u8], source: &ModelSource) -> Result<PackedContents, DdlError> {
    let damaged = |error: &dyn std::fmt::Display| {
        source.wrong(format!(
            "is not a complete packed model ({error}); copy it again, or pack its run again with `ddl pack`"
        ))
    };
    let file = SafeTensors::deserialize(bytes).map_err(|error| damaged(&error))?;
    let (_, metadata) = SafeTensors::read_metadata(bytes).map_err(|error| damaged(&error))?;
    let entry = metadata.metadata().as_ref().and_then(|m| m.get(ENTRY));
    let Some(entry) = entry else {
        return Err(source.wrong(
            "holds weights, but is not a packed model: its header has no configuration; give the directory of the \
             run, or pack the run with `ddl pack`",
        ));
    };
    let PackedHeader { layout, config, motions, sha256 } =
        serde_json::from_str(entry).map_err(|error| damaged(&error))?;
    if layout != LAYOUT {
        return Err(source.wrong(format!("has layout {layout}, this program reads {LAYOUT}; pack its run again")));
    }
    let mut tensors = tensors_of(&file).map_err(|problem| damaged(&problem))?;
    // Check the digest before using the configuration.
    let parts = [config.as_str(), motions.as_deref().unwrap_or_default()];
    if digest(parts, &tensors) != sha256 {
        return Err(damaged(&"its SHA-256 does not match its configuration and weights"));
    }
    let other = |error: &dyn std::fmt::Display| {
        source.wrong(format!("was packed by another version of this program ({error}); pack its run again"))
    };
    let ConfigFormat { format } = serde_json::from_str(&config).map_err(|error| other(&error))?;
    if format != FORMAT {
        return Err(other(&format!("it is of a run of layout {format}, this program reads {FORMAT}")));
    }
    let config = serde_json::from_str(&config).map_err(|error| other(&error))?;
    let motions = motions.map(|motions| serde_json::from_str(&motions)).transpose();
    let motions: Option<TrainingMotions> = motions.map_err(|error| other(&error))?;
    if motions.as_ref().is_some_and(|motions| !motions.is_valid()) {
        return Err(source.wrong("has training motions with impossible numbers; pack its run again"));
    }
    let fingerprints = tensors.iter().position(|tensor| tensor.name == FINGERPRINTS);
    let fingerprints = fingerprints.and_then(|at| TrackFingerprints::from_bytes(&tensors.remove(at).bytes));
    let Some(fingerprints) = fingerprints else {
        return Err(source.wrong("has no fingerprints of its training tracks; pack its run again"));
    };
    Ok(PackedContents { config, motions, fingerprints, tensors })
}

/// The type of the numbers of a tensor of this name.
pub(crate) fn dtype_of(name: &str) -> Dtype {
    if name == FINGERPRINTS { Dtype::U8 } else { Dtype::F16 }
}

/// A tensor of numbers of another type.
#[derive(Debug, thiserror::Error)]
#[error("{name} holds {found:?}, expected {expected:?}")]
struct OtherNumbers {
    name: String,
    found: Dtype,
    expected: Dtype,
}

fn tensors_of(file: &SafeTensors<'_>) -> Result<Vec<HalfTensor>, OtherNumbers> {
    let half = |(name, view): (&str, TensorView<'_>)| {
        let expected = dtype_of(name);
        if view.dtype() != expected {
            return Err(OtherNumbers { name: name.to_owned(), found: view.dtype(), expected });
        }
        Ok(HalfTensor { name: name.to_owned(), shape: view.shape().to_vec(), bytes: view.data().to_vec() })
    };
    file.iter().map(half).collect()
}

pub(crate) fn config(bytes: &[u8], source: &ModelSource) -> Result<RunConfig, DdlError> {
    contents(bytes, source).map(|contents| contents.config)
}

pub(crate) fn unpack(bytes: &[u8], source: &ModelSource, device: Device) -> Result<Unpacked, DdlError> {
    let PackedContents { config, motions, fingerprints, tensors } = contents(bytes, source)?;
    source.check(&config)?;
    let Some(recipe) = &config.goals.proposal else {
        return Err(source.wrong("has no proposal network for its goals; pack another run"));
    };
    let mut of_network = Vec::new();
    let mut of_proposal = Vec::new();
    for tensor in tensors {
        let (list, name) = if let Some(name) = tensor.name.strip_prefix(NETWORK) {
            (&mut of_network, name.to_owned())
        } else if let Some(name) = tensor.name.strip_prefix(PROPOSAL) {
            (&mut of_proposal, name.to_owned())
        } else {
            return Err(source.wrong(format!(
                "holds {}, which belongs to neither network; pack its run again with `ddl pack`",
                tensor.name
            )));
        };
        list.push(HalfTensor { name, ..tensor });
    }
    let unfit = |error: DdlError| match error {
        DdlError::Network(error @ NetworkError::Weights { .. }) => {
            source.wrong(format!("does not fit the networks it describes ({error}); pack its run again"))
        }
        other => other,
    };
    // Allocate only networks whose sizes match the weights in the file.
    for (tensors, least) in
        [(&of_network, config.star.min_weight_count()), (&of_proposal, recipe.network.min_weight_count())]
    {
        let bytes: usize = tensors.iter().map(|tensor| tensor.bytes.len()).sum();
        let numbers = bytes as u64 / 2;
        if numbers < least {
            return Err(source.wrong(format!(
                "does not fit the networks it describes ({numbers} weights, but the networks have more than {least}); \
                 pack its run again"
            )));
        }
    }
    let network = device.forecasting(&config.star, |layout| Weights::from_half(layout, &of_network)).map_err(unfit)?;
    let proposal =
        device.proposing(&recipe.network, |layout| Weights::from_half(layout, &of_proposal)).map_err(unfit)?;
    Ok(Unpacked { config, network, proposal, motions, fingerprints })
}

/// SHA-256 of the strings of the header and of the name, shape and bytes of every tensor, in the order of the names.
pub(crate) fn digest(texts: [&str; 2], tensors: &[HalfTensor]) -> String {
    let mut by_name: Vec<&HalfTensor> = tensors.iter().collect();
    by_name.sort_by(|one, other| one.name.cmp(&other.name));
    let mut hasher = Sha256::new();
    let mut part = |bytes: &[u8]| {
        // The length goes in front, so that no part can be read as the beginning of the next.
        hasher.update((bytes.len() as u64).to_le_bytes());
        hasher.update(bytes);
    };
    for text in texts {
        part(text.as_bytes());
    }
    for tensor in by_name {
        part(tensor.name.as_bytes());
        let shape: Vec<u8> = tensor.shape.iter().flat_map(|&size| (size as u64).to_le_bytes()).collect();
        part(&shape);
        part(&tensor.bytes);
    }
    in_hex(hasher)
}
