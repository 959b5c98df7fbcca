//! Writes a model as one small file.

use crate::error::DdlError;
use crate::goals::model::GoalModel;
use crate::goals::packed::{ENTRY, FINGERPRINTS, LAYOUT, NETWORK, PROPOSAL, PackedHeader, digest, dtype_of};
use ddl_core::Setting;
use ddl_network::ForecastWindows;
use ddl_network::weights::HalfTensor;
use safetensors::tensor::TensorView;
use std::collections::HashMap;

pub(crate) fn pack(network: &dyn ForecastWindows, goals: &GoalModel) -> Result<Vec<u8>, DdlError> {
    let source = goals.source();
    let Some(proposal) = goals.proposal_network() else {
        return Err(source.wrong(format!(
            "cannot be packed: all of its goals come from the expert library, which is trajectory data and is not \
             packed; train a model with {}",
            Setting::Goals.to("proposed")
        )));
    };
    let mut tensors = Vec::new();
    for (prefix, weights) in [(NETWORK, network.copy_weights()?), (PROPOSAL, proposal.copy_weights()?)] {
        for tensor in weights.to_half()? {
            let name = format!("{prefix}{}", tensor.name);
            tensors.push(HalfTensor { name, ..tensor });
        }
    }
    let bytes = goals.fingerprints().to_bytes();
    tensors.push(HalfTensor { name: FINGERPRINTS.to_owned(), shape: vec![bytes.len()], bytes });
    let failed = |error: &dyn std::fmt::Display| source.wrong(format!("cannot be packed: {error}"));
    let config = serde_json::to_string(goals.config()).map_err(|error| failed(&error))?;
    let motions = goals.motions().map(serde_json::to_string).transpose().map_err(|error| failed(&error))?;
    let header = PackedHeader {
        layout: LAYOUT,
        sha256: digest([&config, motions.as_deref().unwrap_or_default()], &tensors),
        config,
        motions,
    };
    let header = serde_json::to_string(&header).map_err(|error| failed(&error))?;
    let views = tensors
        .iter()
        .map(|tensor| {
            let view = TensorView::new(dtype_of(&tensor.name), tensor.shape.clone(), &tensor.bytes)?;
            Ok((&tensor.name, view))
        })
        .collect::<Result<Vec<_>, safetensors::SafeTensorError>>()
        .map_err(|error| failed(&error))?;
    let header = HashMap::from([(ENTRY.to_owned(), header)]);
    safetensors::serialize(views, Some(header)).map_err(|error| failed(&error))
}
