use std::collections::HashMap;

use ddl::network::weights::HalfTensor;
use safetensors::tensor::{Dtype, TensorView};
use sha2::{Digest as _, Sha256};

use super::smallest;
use crate::outside_bytes::edits::Choices;

/// Number of tensors of a file that no network is created from.
const FEW: usize = 4;

pub(super) struct PackedFile {
    config: String,
    tensors: Vec<HalfTensor>,
    file: Vec<u8>,
}

impl PackedFile {
    pub(super) fn whole() -> Self {
        let config = smallest::config();
        let (network, proposal) = (smallest::network(&config), smallest::proposal(&config));
        let mut tensors = Vec::new();
        for (head, weights) in [("network.", network.weights()), ("proposal.", proposal.weights())] {
            for tensor in weights.to_half().expect("new weights are small") {
                let name = format!("{head}{}", tensor.name);
                tensors.push(HalfTensor { name, ..tensor });
            }
        }
        let config = serde_json::to_string(&config).expect("a configuration can be written");
        Self::of(config, tensors)
    }

    /// Keeps few tensors, for readers that create no networks: edits then hit the rest of the header more often,
    /// because most of the header is names of tensors.
    pub(super) fn of_few_tensors(&self) -> Self {
        Self::of(self.config.clone(), self.tensors[..FEW].to_vec())
    }

    fn of(config: String, tensors: Vec<HalfTensor>) -> Self {
        Self {
            file: packed(&config, &tensors),
            config,
            tensors,
        }
    }

    /// An edited file, and whether it is the valid one without edits.
    pub(super) fn edited(&self, bytes: &[u8]) -> (Vec<u8>, bool) {
        let mut choices = Choices::new(bytes);
        let way = choices.byte() % 4;
        let file = match way {
            0 => choices.rest().to_vec(),
            1 => Choices::edited(choices.rest(), &self.file),
            2 => {
                let config = Choices::edited(choices.rest(), self.config.as_bytes());
                packed(&String::from_utf8_lossy(&config), &self.tensors)
            }
            _ => {
                let mut tensors = self.tensors.clone();
                while !choices.is_empty() && !tensors.is_empty() {
                    forge(&mut tensors, &mut choices);
                }
                packed(&self.config, &tensors)
            }
        };
        (file, way > 0 && bytes.len() <= 1)
    }
}

fn forge(tensors: &mut Vec<HalfTensor>, choices: &mut Choices<'_>) {
    let index = choices.below(tensors.len());
    match choices.byte() % 6 {
        0 => drop(tensors.remove(index)),
        1 => {
            let mut twin = tensors[index].clone();
            // The writer of such files accepts each name only once.
            while tensors.iter().any(|tensor| tensor.name == twin.name) {
                twin.name.push('x');
            }
            tensors.push(twin);
        }
        2 => tensors[index].shape.reverse(),
        3 => tensors[index].shape.push(choices.below(3)),
        4 => {
            let bytes = &mut tensors[index].bytes;
            let place = choices.below(bytes.len());
            let new: [u8; 2] = choices.bytes();
            for (byte, new) in bytes[place..].iter_mut().zip(new) {
                *byte = new;
            }
        }
        _ => {
            let size = choices.below(9);
            tensors[index].shape = vec![size];
            tensors[index].bytes = vec![choices.byte(); 2 * size];
        }
    }
}

/// The file of a configuration and tensors, with their digest, in the layout of `ddl pack`.
fn packed(config: &str, tensors: &[HalfTensor]) -> Vec<u8> {
    let mut by_name: Vec<_> = tensors.iter().collect();
    by_name.sort_by(|one, other| one.name.cmp(&other.name));
    let mut hasher = Sha256::new();
    let mut part = |bytes: &[u8]| {
        hasher.update((bytes.len() as u64).to_le_bytes());
        hasher.update(bytes);
    };
    part(config.as_bytes());
    // No training motions.
    part(b"");
    for tensor in by_name {
        part(tensor.name.as_bytes());
        let sizes = tensor.shape.iter();
        let shape: Vec<u8> = sizes.flat_map(|&size| (size as u64).to_le_bytes()).collect();
        part(&shape);
        part(&tensor.bytes);
    }
    let digits = |byte: &u8| [byte >> 4, byte & 15].map(|digit| char::from(b"0123456789abcdef"[usize::from(digit)]));
    let sha256: String = hasher.finalize().iter().flat_map(digits).collect();
    let entry = serde_json::json!({ "layout": 3, "config": config, "sha256": sha256 });
    let header = HashMap::from([("ddl".to_owned(), entry.to_string())]);
    let views = tensors.iter().filter_map(|tensor| {
        let view = TensorView::new(Dtype::F16, tensor.shape.clone(), &tensor.bytes).ok()?;
        Some((tensor.name.as_str(), view))
    });
    safetensors::serialize(views, Some(header)).expect("the parts make a file")
}
