//! Memory files: a line of text with the SHA-256 of the rest, and the memory as JSON.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::fs::File;
use std::io::{ErrorKind, Read as _};
use std::path::Path;

use ddl_core::{PedestrianId, write_atomically};
use ddl_data::checked_frame;
use serde::{Deserialize, Serialize};
use sha2::{Digest as _, Sha256};

use crate::error::{ContentFault, MemoryError};
use crate::memory::{SceneMemory, Seen};
use crate::track::{MAX_RUNS, RunningTrack, Track};

/// The beginning of a file: format and version.
const MAGIC: &str = "ddl-memory 1 ";
/// The beginning of a file of any version.
const ANY_VERSION: &str = "ddl-memory ";
/// Bytes of the first line: `MAGIC`, 64 hexadecimal digits, a line feed.
const HEAD: usize = MAGIC.len() + 65;
/// A memory of the largest capacity has fewer bytes.
const MOST_BYTES: u64 = 1 << 29;

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Stored<'a> {
    frame_step: i64,
    capacity: usize,
    last_frame: Option<i64>,
    seen: Seen,
    ended: Cow<'a, [Track]>,
    running: Cow<'a, BTreeMap<PedestrianId, RunningTrack>>,
}

impl SceneMemory {
    /// Writes the memory, including the pedestrians currently present. The file is replaced once the new one is
    /// complete.
    ///
    /// # Errors
    /// [`MemoryError::Write`] if the file cannot be written; an existing file then stays unchanged.
    pub fn write(&self, path: &Path) -> Result<(), MemoryError> {
        let stored = Stored {
            frame_step: self.frame_step,
            capacity: self.capacity,
            last_frame: self.last_frame,
            seen: self.seen,
            ended: Cow::Borrowed(&self.ended),
            running: Cow::Borrowed(&self.running),
        };
        let content = serde_json::to_vec(&stored).map_err(std::io::Error::from);
        let written = content.and_then(|content| {
            let head = head(&content).into_bytes();
            write_atomically(path, &[head, content].concat())
        });
        written.map_err(|source| MemoryError::Write { path: path.to_owned(), source })
    }

    /// Whether the first bytes of a file are those of a memory, even of another version or a damaged one.
    #[must_use]
    pub fn begins(bytes: &[u8]) -> bool {
        bytes.starts_with(ANY_VERSION.as_bytes())
    }

    /// Reads a memory file. If the tracker has restarted since, call [`end_tracks`](Self::end_tracks) next.
    ///
    /// # Errors
    /// [`MemoryError::Read`] if the file cannot be read, [`MemoryError::File`] if its content is invalid or damaged.
    pub fn read(path: &Path) -> Result<Self, MemoryError> {
        let failed = |source| MemoryError::Read { path: path.to_owned(), source };
        let refused = |fault: ContentFault| MemoryError::File { path: path.to_owned(), problem: fault.to_string() };
        let mut file = File::open(path).map_err(failed)?;
        let mut start = [0; HEAD];
        match file.read_exact(&mut start) {
            Err(error) if error.kind() != ErrorKind::UnexpectedEof => return Err(failed(error)),
            _ if !start.starts_with(MAGIC.as_bytes()) => {
                return Err(refused(ContentFault::Beginning(MAGIC)));
            }
            _ => (),
        }
        let mut content = Vec::new();
        file.take(MOST_BYTES + 1).read_to_end(&mut content).map_err(failed)?;
        if content.len() as u64 > MOST_BYTES {
            return Err(refused(ContentFault::TooLarge(MOST_BYTES)));
        }
        if head(&content).as_bytes() != start {
            return Err(refused(ContentFault::Damaged));
        }
        let stored = serde_json::from_slice(&content).map_err(|error| refused(error.into()))?;
        checked(stored).map_err(refused)
    }
}

fn head(content: &[u8]) -> String {
    let mut line = MAGIC.to_owned();
    for byte in Sha256::digest(content) {
        let _ = write!(line, "{byte:02x}"); // writing to a string cannot fail
    }
    line + "\n"
}

/// Checks the content, and returns the memory.
fn checked(stored: Stored<'_>) -> Result<SceneMemory, ContentFault> {
    let mut memory = SceneMemory::new(stored.frame_step, stored.capacity).map_err(Box::new)?;
    memory.last_frame = stored.last_frame;
    memory.seen = stored.seen;
    memory.ended = stored.ended.into_owned();
    memory.running = stored.running.into_owned();
    if memory.ended.iter().any(|track| track.segments() == 0) {
        return Err(ContentFault::Tracks("a track that has ended holds no segment"));
    }
    let of_running = memory.running.values();
    let last_frames = of_running.clone().map(|running| running.last);
    for frame in last_frames.clone().chain(memory.last_frame) {
        checked_frame(frame, None, [])?;
    }
    let last_rows: Option<Vec<i64>> = of_running.clone().map(|running| running.last_row(memory.frame_step)).collect();
    let far = ContentFault::Tracks("the last row of a pedestrian lies far from its last step");
    let last_rows = last_rows.ok_or(far)?;
    if last_rows.into_iter().max() > memory.last_frame {
        return Err(ContentFault::Tracks("a pedestrian was seen after the last frame"));
    }
    for track in memory.ended.iter().chain(of_running.map(|running| &running.track)) {
        let earlier = track.pieces.split_last().map_or(&[][..], |(_, earlier)| earlier);
        if track.pieces.len() > MAX_RUNS || earlier.iter().any(|piece| piece.len() == 0) {
            return Err(ContentFault::Tracks("a track has too many runs, or too short ones"));
        }
        memory.segments += track.segments();
    }
    if memory.segments > memory.capacity {
        return Err(ContentFault::Segments { segments: memory.segments, capacity: memory.capacity });
    }
    Ok(memory)
}
