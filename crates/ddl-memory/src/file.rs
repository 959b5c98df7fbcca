//! A memory in a file.
//!
//! All numbers are of 8 bytes, little-endian: `i64` for frames and ids, `u64` for counts, `f64` for positions (m).
//!
//! ```text
//! file     "DDLSCENE"  version (u64: 1)  SHA-256 of all that follows (32 bytes)  content
//! content  frame step, capacity, frames, raw frames watched, pedestrians, observations
//!          n (0 or 1), n x last frame
//!          positions: none, or least and largest x and y
//!          n, n x track                                                 ended, in the order in which they ended
//!          n, n x (last seen, last frame of the run, positions, track)  running, by increasing id
//! track    number, id, n, n x positions                                 runs of 1 to 8 stretches: 20 to 27 positions
//! positions  n, n x (x, y)
//! ```

use std::collections::BTreeMap;
use std::fs::File;
use std::io::Read as _;
use std::path::Path;

use ddl_data::{PedestrianId, Position, WINDOW, write_whole};
use sha2::{Digest as _, Sha256};

use crate::limits::{is_capacity, is_frame, is_frame_step, is_near};
use crate::memory::Seen;
use crate::piece::{LANES, Piece};
use crate::track::{LONGEST_RUN, MOST_PIECES, RunningTrack, Track};
use crate::{MemoryError, SceneMemory};

const MAGIC: &[u8; 8] = b"DDLSCENE";
const VERSION: u64 = 1;
const WORD: usize = 8;
const DIGEST: usize = 32;
/// Bytes: more than a memory of the largest capacity takes.
const LARGEST_FILE: u64 = 1 << 28;

impl SceneMemory {
    /// Writes the memory, running tracks and all, to a file that is replaced when the new one is whole.
    ///
    /// # Errors
    /// [`MemoryError::Write`] if the file cannot be written; an earlier one is then left as it was.
    pub fn write(&self, path: &Path) -> Result<(), MemoryError> {
        let mut content = Writer(Vec::new());
        content.memory(self);
        let content = content.0;
        let digest = Sha256::digest(&content);
        let parts = [MAGIC, &VERSION.to_le_bytes()[..], &digest[..], &content];
        write_whole(path, &parts.concat()).map_err(|source| MemoryError::Write {
            path: path.to_owned(),
            source,
        })
    }

    /// Reads a memory as it was written. If the tracker has restarted since the file was written, call
    /// [`interrupt`](Self::interrupt) next.
    ///
    /// # Errors
    /// [`MemoryError::Read`] if the file cannot be read, [`MemoryError::File`] if it is not what was written.
    pub fn read(path: &Path) -> Result<Self, MemoryError> {
        let mut bytes = Vec::new();
        let file =
            File::open(path).and_then(|file| file.take(LARGEST_FILE + 1).read_to_end(&mut bytes));
        file.map_err(|source| MemoryError::Read {
            path: path.to_owned(),
            source,
        })?;
        parse(&bytes).map_err(|problem| MemoryError::File {
            path: path.to_owned(),
            problem,
        })
    }
}

fn parse(bytes: &[u8]) -> Result<SceneMemory, String> {
    if bytes.len() as u64 > LARGEST_FILE {
        return Err(format!("it has more than {LARGEST_FILE} bytes"));
    }
    let rest = bytes
        .strip_prefix(MAGIC)
        .ok_or("it does not begin with DDLSCENE")?;
    let short = || format!("it ends after {} bytes, within its head", bytes.len());
    let (version, rest) = rest.split_first_chunk::<WORD>().ok_or_else(short)?;
    let version = u64::from_le_bytes(*version);
    if version != VERSION {
        return Err(format!(
            "it is of version {version}, and this program reads version {VERSION}"
        ));
    }
    let (digest, content) = rest.split_first_chunk::<DIGEST>().ok_or_else(short)?;
    if Sha256::digest(content)[..] != digest[..] {
        return Err(
            "it is damaged or cut off: the SHA-256 of its content is not the one in its head"
                .to_owned(),
        );
    }
    let mut words = Words(content);
    let memory = words.memory()?;
    if words.0.is_empty() {
        Ok(memory)
    } else {
        Err(format!("{} bytes follow its last track", words.0.len()))
    }
}

struct Writer(Vec<u8>);

impl Writer {
    fn count(&mut self, count: u64) {
        self.0.extend(count.to_le_bytes());
    }

    fn signed(&mut self, number: i64) {
        self.0.extend(number.to_le_bytes());
    }

    fn position(&mut self, position: Position) {
        self.0.extend(position.map(f64::to_le_bytes).as_flattened());
    }

    fn positions(&mut self, positions: &[Position]) {
        self.count(positions.len() as u64);
        for position in positions {
            self.position(*position);
        }
    }

    fn track(&mut self, track: &Track) {
        self.count(track.number);
        self.signed(track.id.0);
        self.count(track.pieces.len() as u64);
        track
            .pieces
            .iter()
            .for_each(|piece| self.positions(piece.path()));
    }

    fn memory(&mut self, memory: &SceneMemory) {
        let seen = &memory.seen;
        self.signed(memory.frame_step);
        self.count(memory.capacity as u64);
        for count in [
            seen.frames,
            seen.watched,
            seen.pedestrians,
            seen.observations,
        ] {
            self.count(count);
        }
        self.count(u64::from(memory.last_frame.is_some()));
        memory
            .last_frame
            .iter()
            .for_each(|frame| self.signed(*frame));
        self.positions(seen.corners.as_ref().map_or(&[], |corners| corners));
        self.count(memory.ended.len() as u64);
        memory.ended.iter().for_each(|track| self.track(track));
        self.count(memory.running.len() as u64);
        for running in memory.running.values() {
            self.signed(running.last_seen);
            self.signed(running.run_end);
            self.positions(&running.run);
            self.track(&running.track);
        }
    }
}

/// What is still to be read. Nothing is allocated for numbers that are not there.
struct Words<'a>(&'a [u8]);

impl Words<'_> {
    fn word(&mut self) -> Result<[u8; WORD], String> {
        let (word, rest) = self
            .0
            .split_first_chunk()
            .ok_or("it ends within its content")?;
        self.0 = rest;
        Ok(*word)
    }

    fn count(&mut self) -> Result<u64, String> {
        Ok(u64::from_le_bytes(self.word()?))
    }

    fn signed(&mut self) -> Result<i64, String> {
        Ok(i64::from_le_bytes(self.word()?))
    }

    fn frame(&mut self) -> Result<i64, String> {
        let frame = self.signed()?;
        if is_frame(frame) {
            Ok(frame)
        } else {
            Err(format!("frame {frame} is out of range"))
        }
    }

    fn position(&mut self) -> Result<Position, String> {
        let position = [
            f64::from_le_bytes(self.word()?),
            f64::from_le_bytes(self.word()?),
        ];
        if is_near(position) {
            Ok(position)
        } else {
            Err(format!("position {position:?} is out of range"))
        }
    }

    /// A number of positions that must lie within the bounds.
    fn positions(&mut self, least: usize, most: usize) -> Result<Vec<Position>, String> {
        let count = self.count()?;
        if !(least as u64..=most as u64).contains(&count) {
            return Err(format!(
                "a list has {count} positions; {least} to {most} are allowed"
            ));
        }
        (0..count).map(|_| self.position()).collect()
    }

    fn track(&mut self, pedestrians: u64) -> Result<Track, String> {
        let number = self.count()?;
        if !(1..=pedestrians).contains(&number) {
            return Err(format!(
                "a track has number {number}, but the file counts {pedestrians} pedestrians"
            ));
        }
        let id = PedestrianId(self.signed()?);
        let count = self.count()?;
        if count > MOST_PIECES as u64 {
            return Err(format!(
                "{count} runs of pedestrian {id}, of at most {MOST_PIECES}"
            ));
        }
        let mut pieces = Vec::new();
        for _ in 0..count {
            let path = self.positions(WINDOW, WINDOW + LANES - 1)?;
            pieces.push(Piece::of(&path).ok_or("a run is too short")?);
        }
        Ok(Track { number, id, pieces })
    }

    fn running(
        &mut self,
        pedestrians: u64,
        last_frame: Option<i64>,
    ) -> Result<RunningTrack, String> {
        let (last_seen, run_end) = (self.frame()?, self.frame()?);
        if run_end > last_seen || last_frame.is_none_or(|last| last_seen > last) {
            return Err("a running track was last seen after the last frame".to_owned());
        }
        let run = self.positions(1, LONGEST_RUN)?;
        let track = self.track(pedestrians)?;
        Ok(RunningTrack {
            track,
            last_seen,
            run,
            run_end,
        })
    }

    fn memory(&mut self) -> Result<SceneMemory, String> {
        let (frame_step, capacity) = (self.signed()?, self.count()?);
        let capacity = usize::try_from(capacity).unwrap_or(usize::MAX);
        if !is_frame_step(frame_step) || !is_capacity(capacity) {
            return Err(format!(
                "frame step {frame_step} and capacity {capacity} are out of range"
            ));
        }
        let [frames, watched, pedestrians, observations] =
            [self.count()?, self.count()?, self.count()?, self.count()?];
        let last_frame = match self.count()? {
            0 => None,
            1 => Some(self.frame()?),
            count => return Err(format!("{count} last frames")),
        };
        let corners = match self.positions(0, 2)?[..] {
            [] => None,
            [low, high] => Some([low, high]),
            _ => return Err("one corner without the other".to_owned()),
        };
        let mut ended = Vec::new();
        for _ in 0..self.count()? {
            let track = self.track(pedestrians)?;
            if track.pieces.is_empty() {
                return Err(format!("pedestrian {} without a stretch", track.id));
            }
            ended.push(track);
        }
        let mut running: BTreeMap<PedestrianId, RunningTrack> = BTreeMap::new();
        for _ in 0..self.count()? {
            let next = self.running(pedestrians, last_frame)?;
            let id = next.track.id;
            if running
                .last_key_value()
                .is_some_and(|(last, _)| *last >= id)
            {
                return Err(format!(
                    "running tracks are not in increasing order of id, at {id}"
                ));
            }
            running.insert(id, next);
        }
        let tracks = running.values().map(|running| &running.track);
        let stretches = ended.iter().chain(tracks).map(Track::stretches).sum();
        if stretches > capacity {
            return Err(format!(
                "it holds {stretches} stretches, more than its capacity {capacity}"
            ));
        }
        let seen = Seen {
            frames,
            watched,
            pedestrians,
            observations,
            corners,
        };
        Ok(SceneMemory {
            frame_step,
            capacity,
            last_frame,
            seen,
            stretches,
            ended,
            running,
        })
    }
}
