//! A file gives back what was written, or is refused.

use std::path::{Path, PathBuf};

use crate::{frames, memory_of, queries};
use ddl_memory::{MemoryError, SceneMemory};
use proptest::prelude::*;

fn folder() -> (tempfile::TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("gate.memory");
    (folder, path)
}

fn read(path: &Path, bytes: &[u8]) -> Result<SceneMemory, String> {
    std::fs::write(path, bytes).unwrap();
    SceneMemory::read(path).map_err(|error| error.to_string())
}

/// The file with its digest made to fit, as somebody would who edits it.
fn signed(mut bytes: Vec<u8>) -> Vec<u8> {
    use sha2::Digest as _;
    let digest = sha2::Sha256::digest(&bytes[48..]);
    bytes[16..48].copy_from_slice(&digest);
    bytes
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(32))]

    #[test]
    fn what_was_written_is_read(frames in crate::crowds(), capacity in 1..2_000_usize) {
        let (_folder, path) = folder();
        let mut memory = memory_of(&frames, capacity);
        memory.write(&path).unwrap();
        let mut read = SceneMemory::read(&path).unwrap();
        prop_assert_eq!(&read, &memory);
        for (id, observed) in queries(&frames) {
            prop_assert_eq!(read.recall(&observed, Some(id), 12), memory.recall(&observed, Some(id), 12));
        }
        // and both go on alike
        let last = frames[frames.len() - 1].0;
        for (frame, people) in &frames {
            memory.observe(last + 1 + frame, people.clone()).unwrap();
            read.observe(last + 1 + frame, people.clone()).unwrap();
        }
        prop_assert_eq!(&read, &memory);
        memory.interrupt();
        memory.write(&path).unwrap();
        prop_assert_eq!(SceneMemory::read(&path).unwrap(), memory);
    }

    #[test]
    fn random_bytes_are_refused(bytes in prop::collection::vec(any::<u8>(), 0..400)) {
        let (_folder, path) = folder();
        prop_assert!(read(&path, &bytes).is_err());
        let head = [b"DDLSCENE".as_slice(), &1_u64.to_le_bytes(), &[0; 32], &bytes].concat();
        prop_assert!(read(&path, &signed(head)).is_err());
    }

    /// Words of the content replaced where the digest fits: an error, or a memory that works.
    #[test]
    fn edited_files_do_no_harm(word in any::<prop::sample::Index>(), early in any::<bool>(), value in prop_oneof![
        any::<u64>(), 0..300_u64, Just(f64::NAN.to_bits()), Just(1e8_f64.to_bits()), Just(u64::MAX),
        Just(i64::MIN as u64),
    ]) {
        let (_folder, path) = folder();
        let frames = frames(2, 4, 60, 2);
        memory_of(&frames, 30).write(&path).unwrap();
        let mut bytes = std::fs::read(&path).unwrap();
        // Half of the edits are of counts and of the first track.
        let words = (bytes.len() - 48) / 8;
        let at = 48 + 8 * word.index(if early { 60 } else { words });
        bytes[at..at + 8].copy_from_slice(&value.to_le_bytes());
        if let Ok(mut memory) = read(&path, &signed(bytes)) {
            for (frame, people) in &frames {
                let _ = memory.observe(1_000 + frame, people.clone());
                prop_assert!(memory.stretches() <= memory.capacity());
            }
            for (id, observed) in queries(&frames) {
                let _ = memory.recall(&observed, Some(id), 12);
            }
        }
    }
}

#[test]
fn damaged_files_are_refused() {
    let (_folder, path) = folder();
    let memory = memory_of(&frames(1, 3, 40, 1), 20);
    memory.write(&path).unwrap();
    let whole = std::fs::read(&path).unwrap();
    for length in 0..whole.len() {
        let error = read(&path, &whole[..length]).unwrap_err();
        assert!(
            error.contains("gate.memory is not a scene memory"),
            "{error}"
        );
        if length >= 48 {
            assert!(read(&path, &signed(whole[..length].to_vec())).is_err());
        }
    }
    for at in 0..whole.len().min(900) {
        let mut bytes = whole.clone();
        bytes[at] ^= 1 << (at % 8);
        assert!(read(&path, &bytes).is_err(), "byte {at}");
    }
    let longer = [whole.as_slice(), &[0; 8]].concat();
    assert!(
        read(&path, &signed(longer))
            .unwrap_err()
            .contains("8 bytes follow")
    );
    let mut newer = whole.clone();
    newer[8] = 2;
    assert!(read(&path, &newer).unwrap_err().contains("of version 2"));
    assert_eq!(read(&path, &whole).unwrap(), memory);
    std::fs::remove_file(&path).unwrap();
    assert!(matches!(
        SceneMemory::read(&path),
        Err(MemoryError::Read { .. })
    ));
    let nowhere = path.join("deep");
    assert!(matches!(
        memory.write(&nowhere),
        Err(MemoryError::Write { .. })
    ));
}
