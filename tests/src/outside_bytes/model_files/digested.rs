//! A file of weights with the SHA-256 of its numbers in its header, and its edits.

use serde_json::Value;

use crate::outside_bytes::edits::Choices;

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
