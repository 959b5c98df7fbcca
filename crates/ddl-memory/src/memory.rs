//! The memory itself: fed frame by frame, never larger than its capacity.

use std::collections::BTreeMap;

use ddl_data::{PedestrianId, Position};

use crate::MemoryError;
use crate::forget::forget;
use crate::limits::{is_capacity, is_frame, is_frame_step, is_near};
use crate::track::{RunningTrack, Track};

/// A full memory forgets this share of its capacity at once.
const FORGOTTEN_AT_ONCE: usize = 32;

/// What one camera has seen so far.
///
/// A *stretch* is 20 positions of one pedestrian, a step of 0.4 s apart, all of them observed. Where frames come faster
/// than steps, the positions of a track that count are those at whole steps after its first frame, or after the first
/// frame behind a hole. A stretch holds positions of observed frames only.
///
/// - A missing step ends a run of stretches. A track ends after more than
///   [`LONGEST_ABSENCE`](crate::LONGEST_ABSENCE) steps without a position. The same id later starts a new track.
/// - The memory holds at most `capacity` stretches. Of one track it holds the latest
///   [`MOST_PIECES`](crate::MOST_PIECES) x 8.
/// - A full memory makes room for 1/32 of its capacity. Of the older half of the ended tracks those go first that have
///   the most newer tracks of their kind: in the middle of the track in the same square of 2 m, with a velocity in the
///   same square of 0.8 m/s. Where all tracks are running, the longest loses its oldest stretches.
/// - Running tracks are shortened only when no ended track is left.
/// - Besides, it holds the people of the last 3.2 s.
/// - The same frames give the same memory, in whichever order the people of a frame come.
///
/// ```
/// use ddl_data::PedestrianId;
/// use ddl_memory::SceneMemory;
///
/// let mut memory = SceneMemory::new(10, SceneMemory::DEFAULT_CAPACITY)?; // 25 frames a second
/// for step in 0..30 {
///     memory.observe(10 * step, [(PedestrianId(1), [0.5 * step as f64, 2.0])])?;
/// }
/// assert_eq!(memory.stretches(), 11);
/// assert!(memory.observe(290, []).is_err());
/// memory.interrupt();
/// memory.observe(0, [(PedestrianId(1), [7.0, 2.0])])?;
/// assert_eq!(memory.summary().pedestrians, 2);
/// # Ok::<(), ddl_memory::MemoryError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct SceneMemory {
    pub(crate) frame_step: i64,
    pub(crate) capacity: usize,
    pub(crate) last_frame: Option<i64>,
    pub(crate) seen: Seen,
    pub(crate) stretches: usize,
    /// Tracks with a stretch at least, in the order in which they ended.
    pub(crate) ended: Vec<Track>,
    pub(crate) running: BTreeMap<PedestrianId, RunningTrack>,
}

/// What is counted and not forgotten.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Seen {
    pub(crate) frames: u64,
    pub(crate) watched: u64,
    pub(crate) pedestrians: u64,
    pub(crate) observations: u64,
    /// Least and largest x and y (m).
    pub(crate) corners: Option<[Position; 2]>,
}

impl Seen {
    fn add(&mut self, [x, y]: Position) {
        let [low, high] = self.corners.unwrap_or([[x, y]; 2]);
        self.observations = self.observations.saturating_add(1);
        self.corners = Some([
            [low[0].min(x), low[1].min(y)],
            [high[0].max(x), high[1].max(y)],
        ]);
    }
}

impl SceneMemory {
    /// Stretches that a memory holds where nothing else is known: those of some hundreds to thousands of pedestrians.
    pub const DEFAULT_CAPACITY: usize = 20_000;

    /// Nothing seen yet; so many raw frames make a step of 0.4 s, such as 10 of a camera at 25 frames a second.
    ///
    /// # Errors
    /// [`MemoryError::FrameStep`] or [`MemoryError::Capacity`] for a number that is out of range.
    pub fn new(frame_step: i64, capacity: usize) -> Result<Self, MemoryError> {
        if !is_frame_step(frame_step) {
            return Err(MemoryError::FrameStep { found: frame_step });
        }
        if !is_capacity(capacity) {
            return Err(MemoryError::Capacity { found: capacity });
        }
        Ok(Self {
            frame_step,
            capacity,
            last_frame: None,
            seen: Seen::default(),
            stretches: 0,
            ended: Vec::new(),
            running: BTreeMap::new(),
        })
    }

    /// Raw frames in one step of 0.4 s.
    pub fn frame_step(&self) -> i64 {
        self.frame_step
    }

    /// The most stretches that are held.
    pub fn capacity(&self) -> usize {
        self.capacity
    }

    /// The last frame observed since the camera started.
    pub fn last_frame(&self) -> Option<i64> {
        self.last_frame
    }

    /// Stretches held, at most the capacity.
    pub fn stretches(&self) -> usize {
        self.stretches
    }

    /// Adds the pedestrians of one frame in any order, with world positions in metres. Frame numbers must increase.
    ///
    /// # Errors
    /// [`MemoryError`] for a frame out of range or not after the last, a position that is not finite or too far from
    /// the origin, or a pedestrian who is there twice. Nothing has changed then.
    pub fn observe(
        &mut self,
        frame: i64,
        people: impl IntoIterator<Item = (PedestrianId, Position)>,
    ) -> Result<(), MemoryError> {
        let people = self.checked(frame, people)?;
        let watched = self.last_frame.map_or(0, |last| frame.abs_diff(last));
        self.seen.watched = self.seen.watched.saturating_add(watched);
        self.seen.frames = self.seen.frames.saturating_add(1);
        self.last_frame = Some(frame);
        let step = self.frame_step;
        self.end_tracks(|track| track.is_gone(frame, step));
        for (id, position) in people {
            self.seen.add(position);
            let running = self.running.entry(id).or_insert_with(|| {
                self.seen.pedestrians = self.seen.pedestrians.saturating_add(1);
                RunningTrack::new(self.seen.pedestrians, id, frame)
            });
            if running.see(frame, position, step) {
                if self.stretches == self.capacity {
                    self.make_room();
                }
                let gone = self.running.get_mut(&id).map_or(1, RunningTrack::keep);
                self.stretches = self.stretches + 1 - gone;
            }
        }
        Ok(())
    }

    /// The camera or its tracker starts anew: all tracks end, and frames may begin at any number. Nothing is forgotten.
    pub fn interrupt(&mut self) {
        self.end_tracks(|_| true);
        self.last_frame = None;
    }

    fn checked(
        &self,
        frame: i64,
        people: impl IntoIterator<Item = (PedestrianId, Position)>,
    ) -> Result<Vec<(PedestrianId, Position)>, MemoryError> {
        if !is_frame(frame) {
            return Err(MemoryError::FrameOutOfRange { frame });
        }
        if let Some(last) = self.last_frame.filter(|last| frame <= *last) {
            return Err(MemoryError::TooEarly { frame, last });
        }
        let mut people: Vec<(PedestrianId, Position)> = people.into_iter().collect();
        people.sort_unstable_by_key(|&(id, _)| id);
        for &(pedestrian, position) in &people {
            if !position.iter().all(|x| x.is_finite()) {
                return Err(MemoryError::NotFinite {
                    pedestrian,
                    frame,
                    position,
                });
            }
            if !is_near(position) {
                return Err(MemoryError::TooFar {
                    pedestrian,
                    frame,
                    position,
                });
            }
        }
        match people.windows(2).find(|pair| pair[0].0 == pair[1].0) {
            Some(pair) => Err(MemoryError::Duplicate {
                pedestrian: pair[0].0,
                frame,
            }),
            None => Ok(people),
        }
    }

    fn end_tracks(&mut self, ends: impl Fn(&RunningTrack) -> bool) {
        let ending = self.running.extract_if(.., |_, running| ends(running));
        for (_, mut running) in ending.filter(|(_, running)| !running.track.pieces.is_empty()) {
            running.track.pieces.shrink_to_fit();
            self.ended.push(running.track);
        }
    }

    /// Forgets until another stretch can be added.
    fn make_room(&mut self) {
        let enough = self.capacity - (self.capacity / FORGOTTEN_AT_ONCE).max(1);
        while self.stretches > enough && !self.ended.is_empty() {
            self.stretches -= forget(&mut self.ended, self.stretches - enough);
        }
        while self.stretches >= self.capacity {
            let tracks = self.running.values_mut().map(|running| &mut running.track);
            let longest = tracks.max_by_key(|track| (track.stretches(), u64::MAX - track.number));
            let Some(track) = longest else { return };
            self.stretches -= track.forget_oldest();
        }
    }
}
