//! A file of weights with the SHA-256 of its numbers in its header, and its edits.

use serde_json::Value;

use crate::outside_bytes::edits::Choices;
use crate::safetensors_file;

/// A sound file in both of its layouts.
pub(super) struct Digested {
    whole: Vec<u8>,
    /// As earlier versions wrote it, without the SHA-256 of its numbers: what lies behind that check is reached too.
    without: Vec<u8>,
}

impl Digested {
    pub(super) fn new(whole: Vec<u8>) -> Self {
        Self {
            without: without_digest(&whole),
            whole,
        }
    }

    /// Edits of one of the two, as the first byte says; at most one byte edits nothing.
    pub(super) fn edited(&self, bytes: &[u8]) -> Vec<u8> {
        match bytes.split_first() {
            None => self.whole.clone(),
            Some((way, edits)) if way & 1 == 0 => Choices::edited(edits, &self.whole),
            Some((_, edits)) => Choices::edited(edits, &self.without),
        }
    }
}

fn without_digest(file: &[u8]) -> Vec<u8> {
    let (mut header, numbers) = safetensors_file::parts(file).expect("a sound file");
    let origin = &mut header["__metadata__"]["origin"];
    let facts = origin.as_str().map(serde_json::from_str::<Value>);
    let mut facts = facts.expect("a sound origin").expect("a sound origin");
    let all = facts.as_object_mut().expect("a sound origin");
    assert!(
        all.remove("numbers.sha256").is_some(),
        "the file has a digest"
    );
    *origin = facts.to_string().into();
    safetensors_file::join(&header, numbers)
}
