//! The file of a scene memory.

use super::valid_file::ValidFile;
use ddl::network::weights::in_hex;
use ddl_core::{OBSERVED, PedestrianId, Position};
use ddl_memory::{MemoryError, SceneMemory};
use sha2::{Digest as _, Sha256};

const PEDESTRIANS: i64 = 3;
const FRAMES: i64 = 45;

fn at(frame: i64, id: i64) -> (PedestrianId, Position) {
    let place = [0.5 * frame as f64, 2.0 * id as f64];
    (PedestrianId(id), place)
}

/// One pedestrian that left, one that came late, one that was missed once.
fn observe(memory: &mut SceneMemory, first: i64) {
    for frame in 0..FRAMES {
        let is_there = |id: &i64| match id {
            0 => frame < 25,
            1 => frame > 20,
            _ => frame != 21,
        };
        let pedestrians = (0..PEDESTRIANS).filter(is_there).map(|id| at(frame, id));
        // An edited memory may have seen a later frame.
        let _ = memory.observe(first + frame, pedestrians);
        assert!(memory.segments() <= memory.capacity());
    }
}

/// The file with the SHA-256 of its present content.
fn with_digest(file: &[u8]) -> Option<Vec<u8>> {
    let end = file.iter().position(|byte| *byte == b'\n')?;
    let head = format!("ddl-memory 1 {}", in_hex(Sha256::new_with_prefix(&file[end + 1..])));
    Some([head.as_bytes(), &file[end..]].concat())
}

/// Reads an edited file. A memory that was read must work. If the first byte says so, it is written and read back.
pub(super) fn read(choices: &[u8]) {
    thread_local! {
        static VALID: ValidFile<()> = ValidFile::new("gate.memory", with_digest, |path| {
            let mut memory = SceneMemory::new(1, 60).expect("in range");
            observe(&mut memory, 0);
            memory.write(path).expect("a file can be written");
        });
    }
    let read = VALID.with(|valid| {
        valid.read(choices, |(), path| Ok::<_, MemoryError>((SceneMemory::read(path)?, path.to_owned())))
    });
    let Ok((mut memory, path)) = read else { return };
    // Writing waits for the disk, so few inputs do it.
    if choices.first().is_none_or(|way| way & 0b1_1110 == 0) {
        memory.write(&path).expect("a file can be written");
        assert_eq!(SceneMemory::read(&path).expect("just written"), memory);
    }
    let observed: [Position; OBSERVED] = std::array::from_fn(|t| at(t as i64 + 9, 2).1);
    for pedestrian in [None, Some(PedestrianId(2))] {
        let recalled = memory.recall(&observed, pedestrian, 4);
        assert!(recalled.is_sorted_by(|a, b| a.distance <= b.distance));
    }
    assert!(memory.tracks().count() <= memory.segments());
    observe(&mut memory, FRAMES);
    memory.end_tracks();
    observe(&mut memory, 0);
    assert!(memory.tracks().count() <= memory.segments());
}
