//! A file restores the written memory, or is refused.

use std::path::{Path, PathBuf};

use crate::{frames, memory_of, queries};
use ddl_memory::{MemoryError, SceneMemory};
use proptest::prelude::*;

fn folder() -> (tempfile::TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("gate.memory");
    (folder, path)
}

fn read(path: &Path, bytes: &[u8]) -> Result<SceneMemory, MemoryError> {
    std::fs::write(path, bytes).unwrap();
    SceneMemory::read(path)
}

/// The content with a matching first line, as after a careful edit.
fn signed(content: &[u8]) -> Vec<u8> {
    use sha2::Digest as _;
    let digits: Vec<String> = sha2::Sha256::digest(content).iter().map(|byte| format!("{byte:02x}")).collect();
    let head = format!("ddl-memory 1 {}\n", digits.concat());
    [head.as_bytes(), content].concat()
}

const HEAD: usize = 78;

proptest! {
    #![proptest_config(ProptestConfig::with_cases(32))]

    #[test]
    fn what_was_written_is_read(frames in crate::crowds(), capacity in 1..2_000_usize, step in 1..10_i64) {
        let (_folder, path) = folder();
        // With any step, also with rows between two.
        let mut memory = SceneMemory::new(step, capacity).unwrap();
        for (frame, pedestrians) in &frames {
            memory.observe(*frame, pedestrians.clone()).unwrap();
        }
        memory.write(&path).unwrap();
        let mut read = SceneMemory::read(&path).unwrap();
        prop_assert_eq!(&read, &memory);
        prop_assert!(SceneMemory::begins(&std::fs::read(&path).unwrap()));
        for (id, observed) in queries(&frames) {
            prop_assert_eq!(read.recall(&observed, Some(id), 12), memory.recall(&observed, Some(id), 12));
        }
        // Both continue identically.
        let last = frames[frames.len() - 1].0;
        for (frame, pedestrians) in &frames {
            memory.observe(last + 1 + frame, pedestrians.clone()).unwrap();
            read.observe(last + 1 + frame, pedestrians.clone()).unwrap();
        }
        prop_assert_eq!(&read, &memory);
        memory.end_tracks();
        memory.write(&path).unwrap();
        prop_assert_eq!(SceneMemory::read(&path).unwrap(), memory);
    }

}

#[test]
fn damaged_files_are_refused() {
    let (_folder, path) = folder();
    let memory = memory_of(&frames(1, 2, 25, 1), 20);
    memory.write(&path).unwrap();
    let whole = std::fs::read(&path).unwrap();
    for length in 0..whole.len() {
        let error = read(&path, &whole[..length]).unwrap_err().to_string();
        let says = "gate.memory is not a readable scene memory";
        assert!(error.contains(says) && error.contains("Restore a copy"), "{error}");
        if length >= HEAD {
            assert!(read(&path, &signed(&whole[HEAD..length])).is_err());
        }
    }
    for place in 0..whole.len() {
        let mut bytes = whole.clone();
        bytes[place] ^= 1 << (place % 8);
        assert!(read(&path, &bytes).is_err(), "byte {place}");
    }
    let longer = [&whole[HEAD..], b"0"].concat();
    let error = read(&path, &signed(&longer)).unwrap_err().to_string();
    assert!(error.contains("trailing characters"), "{error}");
    assert_eq!(read(&path, &whole).unwrap(), memory);
    std::fs::remove_file(&path).unwrap();
    assert!(matches!(SceneMemory::read(&path), Err(MemoryError::Read { .. })));
    let nowhere = path.join("deep");
    assert!(matches!(memory.write(&nowhere), Err(MemoryError::Write { .. })));
}

/// Invalid content that the digest does not reveal, because it was computed again after the edit.
#[test]
fn impossible_memories_are_refused() {
    let (_folder, path) = folder();
    memory_of(&frames(1, 2, 25, 1), 20).write(&path).unwrap();
    let text = std::fs::read_to_string(&path).unwrap();
    for (from, to, problem) in [
        ("\"capacity\":20", "\"capacity\":1", "more than its capacity 1"),
        ("\"capacity\":20", "\"capacity\":0", "the capacity is 0 segments"),
        ("\"frame_step\":1", "\"frame_step\":0", "the frame step must lie"),
        ("\"last_frame\":24", "\"last_frame\":23", "after the last frame"),
        ("\"last_frame\":24", "\"last_frame\":9007199254740992", "not below 2^53"),
        ("\"last\":24", "\"last\":-9223372036854775808", "not below 2^53"),
        ("\"track\":[[", "\"track\":[[[0,0]],[", "too short"),
        ("\"track\":[[", "\"track\":[[],[", "a run has 0 positions"),
        ("\"track\":[[[", "\"track\":[[[1.1e7,0],[", "too far from the origin"),
        ("\"seen\"", "\"more\":0,\"seen\"", "unknown field `more`"),
    ] {
        assert!(text.contains(from), "{from}");
        let edited = text[HEAD..].replacen(from, to, 1);
        let error = read(&path, &signed(edited.as_bytes())).unwrap_err().to_string();
        assert!(error.contains(problem), "{error}");
    } // A row between two steps: 3 after the step at frame 20.
    let mut memory = SceneMemory::new(10, 20).unwrap();
    for frame in [10, 20, 23] {
        memory.observe(frame, [(ddl_core::PedestrianId(1), [0.1 * frame as f64, 0.0])]).unwrap();
    }
    memory.write(&path).unwrap();
    let text = std::fs::read_to_string(&path).unwrap();
    for (row, problem) in [
        ("[20,[2.3,0.0]]", "far from its last step"),
        ("[30,[2.3,0.0]]", "far from its last step"),
        ("[23,[2.3,1e8]]", "far from its last step"),
        ("[24,[2.3,0.0]]", "after the last frame"),
    ] {
        let row = format!("\"between\":{row}");
        let (before, after) = text[HEAD..].split_once("\"between\":").unwrap();
        let edited = [before, &row, &after[after.find("]]").unwrap() + 2..]].concat();
        let error = read(&path, &signed(edited.as_bytes())).unwrap_err().to_string();
        assert!(error.contains(problem), "{error}");
    }
}
