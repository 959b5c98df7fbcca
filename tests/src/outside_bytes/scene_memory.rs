//! The file of a scene memory.

use std::fmt::Write as _;
use std::path::PathBuf;

use ddl_data::{OBSERVED, PedestrianId, Position};
use ddl_memory::SceneMemory;
use sha2::{Digest as _, Sha256};
use tempfile::TempDir;

use super::edits::Choices;

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

struct Sound {
    folder: TempDir,
    file: Vec<u8>,
    /// Length of its first line.
    head: usize,
}

impl Sound {
    fn new() -> Self {
        let folder = tempfile::tempdir().expect("a folder can be made");
        let mut memory = SceneMemory::new(1, 60).expect("in range");
        observe(&mut memory, 0);
        let path = folder.path().join("gate.memory");
        memory.write(&path).expect("a file can be written");
        let file = std::fs::read(&path).expect("the file was written");
        let head = file.iter().position(|byte| *byte == b'\n');
        let head = head.expect("a first line") + 1;
        Self { folder, file, head }
    }

    fn path(&self) -> PathBuf {
        self.folder.path().join("gate.memory")
    }

    /// Edits of the file, or of its content with an updated digest; the first byte decides.
    fn edited(&self, bytes: &[u8]) -> Vec<u8> {
        match bytes.split_first() {
            None => self.file.clone(),
            Some((way, edits)) if way & 1 == 0 => Choices::edited(edits, &self.file),
            Some((_, edits)) => {
                let content = Choices::edited(edits, &self.file[self.head..]);
                let mut head = "ddl-memory 1 ".to_owned();
                for byte in Sha256::digest(&content) {
                    let _ = write!(head, "{byte:02x}");
                }
                [head.as_bytes(), b"\n", &content].concat()
            }
        }
    }
}

/// Reads an edited file. With at most one byte nothing is edited. A memory that was read must work. If the first byte
/// says so, it is written and read back.
pub fn read(bytes: &[u8]) {
    thread_local! {
        static SOUND: Sound = Sound::new();
    }
    SOUND.with(|sound| {
        let path = sound.path();
        std::fs::write(&path, sound.edited(bytes)).expect("a file can be written");
        let mut memory = match SceneMemory::read(&path) {
            Ok(memory) => memory,
            Err(error) => {
                assert!(bytes.len() > 1, "a valid file: {error}");
                let text = error.to_string();
                assert!(text.contains("gate.memory"), "{text}");
                return;
            }
        };
        // Writing waits for the disk, so few inputs do it.
        if bytes.first().is_none_or(|way| way & 0b1_1110 == 0) {
            memory.write(&path).expect("a file can be written");
            assert_eq!(SceneMemory::read(&path).expect("just written"), memory);
        }
        let observed: [Position; OBSERVED] = std::array::from_fn(|t| at(t as i64 + 9, 2).1);
        for own in [None, Some(PedestrianId(2))] {
            let recalled = memory.recall(&observed, own, 4);
            assert!(recalled.is_sorted_by(|a, b| a.distance <= b.distance));
        }
        assert!(memory.tracks().count() <= memory.segments());
        observe(&mut memory, FRAMES);
        memory.end_tracks();
        observe(&mut memory, 0);
        assert!(memory.tracks().count() <= memory.segments());
    });
}
