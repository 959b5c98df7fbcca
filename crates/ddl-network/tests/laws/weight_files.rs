//! Weights are read from files as they were written, and broken files are refused.

use ddl_network::weights::{
    Origin, StoredTensor, TensorData, Weights, load_weights, read_tensors, save_weights, tensors_digest, write_tensors,
};
use ddl_network::{
    ForecastWindows as _, MotionNetwork, NetworkError, ProposalConfig, ProposalNetwork, ProposeEndpoints as _,
    StarConfig, Variant,
};
use safetensors::SafeTensors;
use safetensors::tensor::{Dtype, TensorView};
use std::path::Path;

fn network(variant: Variant, seed: u64) -> MotionNetwork {
    let config = StarConfig { feed_forward_width: 64, ..StarConfig::published(variant) };
    MotionNetwork::new(config, seed).unwrap()
}

fn weights(variant: Variant, seed: u64) -> Weights {
    network(variant, seed).copy_weights().unwrap()
}

fn origin() -> Origin {
    Origin::from_iter([("fold", "corridor"), ("seed", "7")])
}

/// The file with changed tensors and a digest that fits them.
fn forged(whole: &[u8], change: impl Fn(&mut String, &mut Dtype, &mut Vec<u8>)) -> Vec<u8> {
    let file = SafeTensors::deserialize(whole).unwrap();
    let mut tensors: Vec<_> = file
        .iter()
        .map(|(name, view)| {
            let (mut name, mut kind) = (name.to_owned(), view.dtype());
            let mut bytes = view.data().to_vec();
            change(&mut name, &mut kind, &mut bytes);
            (name, kind, view.shape().to_vec(), bytes)
        })
        .collect();
    tensors.sort_by(|a, b| a.0.cmp(&b.0));
    let views = || {
        tensors
            .iter()
            .map(|(name, kind, shape, bytes)| (name.as_str(), TensorView::new(*kind, shape.clone(), bytes).unwrap()))
    };
    safetensors::serialize(views(), Some(origin().to_header(&tensors_digest(views())))).unwrap()
}

fn refuse(bytes: &[u8], expected: &str) {
    let folder = tempfile::tempdir().unwrap();
    let broken = folder.path().join("broken.safetensors");
    std::fs::write(&broken, bytes).unwrap();
    let error = load_weights(weights(Variant::Full, 2).layout(), &origin(), &broken).unwrap_err();
    assert!(matches!(error, NetworkError::Checkpoint { .. }), "{error}");
    assert!(error.to_string().contains(expected), "{expected}: {error}");
    assert!(error.to_string().contains("broken.safetensors"), "{error}");
}

fn saved(weights: &Weights, origin: &Origin) -> Vec<u8> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("model.safetensors");
    save_weights(weights, origin, &path).unwrap();
    std::fs::read(&path).unwrap()
}

#[test]
fn weights_survive_the_file() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("model.safetensors");
    let check = |weights: &Weights| {
        save_weights(weights, &origin(), &path).unwrap();
        let loaded = load_weights(weights.layout(), &origin(), &path).unwrap();
        assert_eq!(&loaded, weights);
    };
    for variant in Variant::ALL {
        check(&weights(variant, 1));
    }
    let proposals = ProposalNetwork::new(ProposalConfig::default(), 1).unwrap();
    check(&proposals.copy_weights().unwrap());
    assert_ne!(weights(Variant::Full, 1), weights(Variant::Full, 2));
}

#[test]
fn broken_files_are_refused() {
    let whole = saved(&weights(Variant::Full, 1), &origin());
    for length in [0, 7, 100, whole.len() / 2, whole.len() - 1] {
        refuse(&whole[..length], "not a complete safetensors file");
    }
    refuse(&vec![0; whole.len() * 3 + (2 << 20)], "bytes long");
    let mut turned = whole.clone();
    let last = turned.len() - 4;
    turned[last] ^= 1;
    refuse(&turned, "the SHA-256 of its numbers");
    // A change before writing, so that the digest is right.
    let renamed = forged(&whole, |name, _, _| {
        if name == "fusion_layer.bias" {
            *name = "xusion_layer.bias".to_owned();
        }
    });
    refuse(&renamed, "has no tensor fusion_layer.bias");
    for number in [f32::NAN, f32::INFINITY] {
        let poisoned = forged(&whole, |_, _, bytes| {
            bytes[..4].copy_from_slice(&number.to_le_bytes());
        });
        refuse(&poisoned, "NaN or infinite");
    }
    let integers = forged(&whole, |_, kind, _| *kind = Dtype::I32);
    refuse(&integers, "expected 32- or 64-bit floats");
}

#[test]
fn files_of_another_network_or_run_are_refused() {
    let network = network(Variant::Full, 1);
    let shape = "output_layer.weight has shape";
    refuse(&saved(&weights(Variant::Star, 2), &origin()), shape);
    let shallow = StarConfig { spatial_layers: 1, ..network.config().clone() };
    let shallow = MotionNetwork::new(shallow, 1).unwrap().copy_weights().unwrap();
    refuse(&saved(&shallow, &origin()), "it was written for another configuration");
    let elsewhere = Origin::from_iter([("fold", "plaza"), ("seed", "7")]);
    let elsewhere = saved(&network.copy_weights().unwrap(), &elsewhere);
    refuse(&elsewhere, "its fold is plaza, not corridor");
    let file = SafeTensors::deserialize(&elsewhere).unwrap();
    let foreign = safetensors::serialize(file.iter(), None).unwrap();
    refuse(&foreign, "its fold is missing, not corridor");
}

fn double(shape: &[usize], numbers: Vec<f64>) -> StoredTensor {
    StoredTensor { name: "moments".to_owned(), shape: shape.to_vec(), numbers: TensorData::Double(numbers) }
}

#[test]
fn tensors_of_either_precision_are_kept_as_they_are() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("state.safetensors");
    let moments = double(&[3], vec![1.0 / 3.0, -0.0, 1e300]);
    write_tensors(std::slice::from_ref(&moments), &origin(), &path).unwrap();
    let read = read_tensors(&path, 24, &origin()).unwrap();
    assert_eq!(read, [moments]);
    assert_eq!(read[0].double(&[3], &path).unwrap()[2].to_bits(), 1e300_f64.to_bits());
    // 1e300 is infinite in single precision.
    let error = read[0].single(&[3], &path).unwrap_err().to_string();
    assert!(error.contains("NaN or infinite"), "{error}");
    let error = read[0].double(&[1, 3], &path).unwrap_err().to_string();
    assert!(error.contains("moments has shape [3], expected [1, 3]"));
}

#[test]
fn a_file_that_cannot_be_written_leaves_the_old_one() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("model.safetensors");
    let weights = weights(Variant::Full, 1);
    save_weights(&weights, &origin(), &path).unwrap();
    let before = std::fs::read(&path).unwrap();
    let impossible = double(&[4], vec![1.0; 3]);
    write_tensors(&[impossible], &origin(), &path).unwrap_err();
    assert_eq!(std::fs::read(&path).unwrap(), before);
    let left: Vec<_> = std::fs::read_dir(folder.path()).unwrap().collect();
    assert_eq!(left.len(), 1, "{left:?}");

    let nowhere = |path: &Path| {
        let error = save_weights(&weights, &origin(), path).unwrap_err();
        assert!(matches!(error, NetworkError::Io { .. }), "{error}");
    };
    nowhere(&folder.path().join("no such folder").join("model.safetensors"));
    // A file cannot replace a folder.
    let taken = folder.path().join("taken");
    std::fs::create_dir_all(taken.join("kept")).unwrap();
    nowhere(&taken);
    assert!(taken.join("kept").is_dir());
}
