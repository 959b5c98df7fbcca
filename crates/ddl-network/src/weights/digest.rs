//! The SHA-256 of the numbers in a weights file. It detects flipped bits, after which most weights are still finite and
//! plausible.

use crate::NetworkError;
use safetensors::SafeTensors;
use safetensors::tensor::TensorView;
use sha2::{Digest as _, Sha256};
use std::fmt::Write as _;
use std::path::Path;

/// SHA-256, in hexadecimal, of the name, type, shape and bytes of each tensor, in the order of the names.
pub fn tensors_digest<'a>(tensors: impl IntoIterator<Item = (&'a str, TensorView<'a>)>) -> String {
    let mut tensors: Vec<_> = tensors.into_iter().collect();
    tensors.sort_by(|one, other| one.0.cmp(other.0));
    let mut hasher = Sha256::new();
    let mut part = |bytes: &[u8]| {
        // The length before each part makes the boundaries between parts unambiguous.
        hasher.update((bytes.len() as u64).to_le_bytes());
        hasher.update(bytes);
    };
    for (name, view) in &tensors {
        part(name.as_bytes());
        part(format!("{:?} {:?}", view.dtype(), view.shape()).as_bytes());
        part(view.data());
    }
    in_hex(hasher)
}

/// The digest in hexadecimal.
pub fn in_hex(hasher: Sha256) -> String {
    let digest = hasher.finalize();
    digest.iter().fold(String::new(), |mut text, byte| {
        let _ = write!(text, "{byte:02x}"); // Writing to a string cannot fail.
        text
    })
}

/// Checks the numbers of the file at `path` against the digest in its header.
///
/// # Errors
/// [`NetworkError::Checkpoint`] if they differ. Files of earlier versions have no digest and are accepted.
pub(super) fn check_digest(file: &SafeTensors<'_>, expected: Option<&str>, path: &Path) -> Result<(), NetworkError> {
    let tensors = file.tensors();
    let digest = || tensors_digest(tensors.iter().map(|(name, view)| (name.as_str(), view.clone())));
    match expected {
        Some(expected) if digest() != expected => Err(NetworkError::checkpoint(
            path,
            "is damaged: the SHA-256 of its numbers is not the one in its header; copy it again, or delete it and run \
             the same training again",
        )),
        _ => Ok(()),
    }
}
