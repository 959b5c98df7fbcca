//! The committed corpora, and edits of them for plain tests.

use std::path::PathBuf;

use super::Reader;
use super::edits::Choices;
use crate::chance::Chance;

const EDITS: u64 = 300;
/// Longest file of which every truncation is read; of a longer one, this many truncations are read.
const MOST_TRUNCATIONS: usize = 2048;

/// The files of a reader's corpus, by name.
pub fn files(reader: &str) -> Vec<(PathBuf, Vec<u8>)> {
    let folder = PathBuf::from(env!("CARGO_MANIFEST_DIR"))
        .join("fuzz/corpus")
        .join(reader);
    let entries =
        std::fs::read_dir(&folder).unwrap_or_else(|error| panic!("{} has no corpus: {error}", folder.display()));
    let mut paths: Vec<PathBuf> = entries
        .map(|entry| entry.expect("the folder can be listed").path())
        .collect();
    paths.sort();
    assert!(!paths.is_empty(), "{} is empty", folder.display());
    let read = |path: PathBuf| {
        let bytes = std::fs::read(&path).expect("the file can be read");
        (path, bytes)
    };
    paths.into_iter().map(read).collect()
}

/// Passes every file of the corpus to a reader, with truncations and some edits, the same at every call.
pub fn run((name, read): Reader) {
    for (path, bytes) in files(name) {
        let hand_over = |bytes: &[u8], how: &str| {
            let caught = std::panic::catch_unwind(|| read(bytes));
            if let Err(panic) = caught {
                eprintln!("{name}, {} {how}: {:?}", path.display(), String::from_utf8_lossy(bytes));
                std::panic::resume_unwind(panic);
            }
        };
        hand_over(&bytes, "whole");
        let stride = bytes.len().div_ceil(MOST_TRUNCATIONS).max(1);
        for length in (0..bytes.len()).step_by(stride) {
            hand_over(&bytes[..length], "cut short");
        }
        for seed in 0..EDITS {
            let mut edited = bytes.clone();
            let mut chance = Chance(seed);
            let noise: Vec<u8> = (0..8).flat_map(|_| chance.number().to_le_bytes()).collect();
            let mut choices = Choices::new(&noise);
            for _ in 0..=(seed % 3) {
                choices.edit(&mut edited);
            }
            hand_over(&edited, "edited");
        }
    }
}
