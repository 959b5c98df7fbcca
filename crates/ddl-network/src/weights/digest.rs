//! The SHA-256 of the numbers in a file, so that a bit that turned on the way is noticed: most such weights still look like weights.

use safetensors::SafeTensors;
use safetensors::tensor::TensorView;
use sha2::{Digest as _, Sha256};
use std::fmt::Write as _;

/// SHA-256 of tensors, in hexadecimal: of each one's name, kind, shape and bytes, by name.
pub fn numbers_digest<'a>(tensors: impl IntoIterator<Item = (&'a str, TensorView<'a>)>) -> String {
    let mut tensors: Vec<_> = tensors.into_iter().collect();
    tensors.sort_by(|one, other| one.0.cmp(other.0));
    let mut hasher = Sha256::new();
    let mut part = |bytes: &[u8]| {
        // with its length, so that no part can pass for the beginning of the next
        hasher.update((bytes.len() as u64).to_le_bytes());
        hasher.update(bytes);
    };
    for (name, view) in &tensors {
        part(name.as_bytes());
        part(format!("{:?} {:?}", view.dtype(), view.shape()).as_bytes());
        part(view.data());
    }
    let digest = hasher.finalize();
    digest.iter().fold(String::new(), |mut text, byte| {
        let _ = write!(text, "{byte:02x}"); // writing to a string cannot fail
        text
    })
}

/// The numbers of a file are not those that were written. Its words are to follow the name of the file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error(
    "is damaged: the SHA-256 of its numbers is not the one in its header; copy it again, or delete it and run the same \
     training again"
)]
pub struct DamagedNumbers;

/// Whether the numbers of a file are those that were written, as far as its header says.
///
/// # Errors
/// [`DamagedNumbers`] when they are not. Files of earlier versions have no digest, and pass.
pub fn check_numbers(file: &SafeTensors<'_>, expected: Option<&str>) -> Result<(), DamagedNumbers> {
    let Some(expected) = expected else {
        return Ok(());
    };
    let tensors = file.tensors();
    let found = numbers_digest(
        tensors
            .iter()
            .map(|(name, view)| (name.as_str(), view.clone())),
    );
    if found == expected {
        Ok(())
    } else {
        Err(DamagedNumbers)
    }
}
