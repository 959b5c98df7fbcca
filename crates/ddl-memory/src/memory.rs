//! The scene memory: updated frame by frame, never larger than its capacity.

use std::collections::BTreeMap;
use std::collections::btree_map::Entry;

use ddl_core::{PedestrianId, Position};
use ddl_data::{Clock, LiveError, checked_frame};
use serde::{Deserialize, Serialize};

use crate::error::MemoryError;
use crate::track::{RunningTrack, Track};

/// Largest capacity in segments; a memory of this size takes up to 180 MB.
const LARGEST_CAPACITY: usize = 1 << 18;
/// A full memory removes this fraction (1/n) of its capacity at once ...
const FORGOTTEN_AT_ONCE: usize = 32;
/// ... from this fraction (1/n) of the tracks, the oldest ones.
const OLDEST: usize = 8;

/// The tracks that one camera has observed.
///
/// A *segment* is 20 positions of one pedestrian, one step of 0.4 s apart: those at whole steps after its first row, or
/// after the first row after a gap. Where no row is at a step, the position lies between two rows.
///
/// - A run of segments ends where a pedestrian has no row for more than 1.2 s. A track ends after more than 8 steps
///   (3.2 s) without a position; if the same id returns later, a new track begins.
/// - Two segments are similar if their squared distance, as defined at [`recall`](Self::recall), is below 1.
/// - A track is kept in runs of up to 8 segments. A run is removed if its first and its last segment are both similar
///   to segments of an earlier run of the same track, except the run right before it. Of the remaining runs, the
///   latest 32 are kept. So a pedestrian that stands for an hour takes the space of three runs.
/// - The memory holds at most `capacity` segments. A full memory frees 1/32 of them among the oldest eighth of the
///   ended tracks. It first removes tracks whose middle is similar to a newer track, then the others, in both cases the
///   oldest first. If no track has ended, the longest one loses its oldest run.
/// - In addition, it holds the pedestrians of the last 3.2 s.
/// - The same frames give the same memory, for any order of the pedestrians within a frame.
///
/// ```
/// use ddl_core::PedestrianId;
/// use ddl_memory::SceneMemory;
///
/// let mut memory = SceneMemory::new(10, SceneMemory::DEFAULT_CAPACITY)?; // 25 frames per second
/// for step in 0..30 {
///     memory.observe(10 * step, [(PedestrianId(1), [0.5 * step as f64, 2.0])])?;
/// }
/// assert_eq!(memory.segments(), 11);
/// assert!(memory.observe(290, []).is_err());
/// memory.end_tracks();
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
    pub(crate) segments: usize,
    /// Tracks with at least one segment, in the order in which they ended.
    pub(crate) ended: Vec<Track>,
    pub(crate) running: BTreeMap<PedestrianId, RunningTrack>,
}

/// Counts that are never reduced.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Seen {
    pub(crate) frames: u64,
    pub(crate) watched: u64,
    pub(crate) pedestrians: u64,
    /// Least and largest x and y (m).
    pub(crate) extent: Option<[Position; 2]>,
}

impl Seen {
    fn add(&mut self, [x, y]: Position) {
        let [low, high] = self.extent.unwrap_or([[x, y]; 2]);
        self.extent = Some([[low[0].min(x), low[1].min(y)], [high[0].max(x), high[1].max(y)]]);
    }
}

impl SceneMemory {
    /// Default capacity in segments: enough for some hundreds to thousands of pedestrians.
    pub const DEFAULT_CAPACITY: usize = 20_000;

    /// An empty memory; `frame_step` is the number of raw frames per step of 0.4 s, such as 10 at 25 frames per second.
    ///
    /// # Errors
    /// [`MemoryError::Frame`] or [`MemoryError::Capacity`] for a number that is out of range.
    pub fn new(frame_step: i64, capacity: usize) -> Result<Self, MemoryError> {
        Clock::with_frame_step(frame_step).map_err(LiveError::from)?;
        if !(1..=LARGEST_CAPACITY).contains(&capacity) {
            return Err(MemoryError::Capacity { capacity, largest: LARGEST_CAPACITY });
        }
        Ok(Self::empty(frame_step, capacity))
    }

    /// An empty memory with the same frame step and capacity.
    #[must_use]
    pub fn empty_copy(&self) -> Self {
        Self::empty(self.frame_step, self.capacity)
    }

    fn empty(frame_step: i64, capacity: usize) -> Self {
        Self {
            frame_step,
            capacity,
            last_frame: None,
            seen: Seen::default(),
            segments: 0,
            ended: Vec::new(),
            running: BTreeMap::new(),
        }
    }

    /// Raw frames per step of 0.4 s.
    pub fn frame_step(&self) -> i64 {
        self.frame_step
    }

    /// The largest number of segments held.
    pub fn capacity(&self) -> usize {
        self.capacity
    }

    /// The last frame observed since the start of the camera.
    pub fn last_frame(&self) -> Option<i64> {
        self.last_frame
    }

    /// Number of segments held, at most the capacity.
    pub fn segments(&self) -> usize {
        self.segments
    }

    /// Adds the pedestrians of one frame in any order, with world positions in metres. Frame numbers must increase.
    ///
    /// A memory accepts the frames that [`LiveTracks`](ddl_data::LiveTracks) accepts.
    ///
    /// # Errors
    /// [`MemoryError::Frame`] for a frame that [`checked_frame`] refuses. The memory is then unchanged.
    pub fn observe(
        &mut self,
        frame: i64,
        positions: impl IntoIterator<Item = (PedestrianId, Position)>,
    ) -> Result<(), MemoryError> {
        self.observe_begun(frame, positions, &[])
    }

    /// As [`observe`](Self::observe). The tracks of the pedestrians in `begun` begin anew: no path joins them to earlier
    /// rows of the same id.
    ///
    /// # Errors
    /// As [`observe`](Self::observe).
    pub fn observe_begun(
        &mut self,
        frame: i64,
        positions: impl IntoIterator<Item = (PedestrianId, Position)>,
        begun: &[PedestrianId],
    ) -> Result<(), MemoryError> {
        let positions = checked_frame(frame, self.last_frame, positions)?;
        let watched = self.last_frame.map_or(0, |last| frame.abs_diff(last));
        self.seen.watched = self.seen.watched.saturating_add(watched);
        self.seen.frames = self.seen.frames.saturating_add(1);
        self.last_frame = Some(frame);
        let step = self.frame_step;
        self.end_tracks_that(|track| track.is_gone(frame, step));
        for (id, position) in positions {
            self.seen.add(position);
            match self.running.entry(id) {
                Entry::Occupied(mut running) => {
                    let running = running.get_mut();
                    let (new, gone) = if begun.contains(&id) {
                        running.begin_anew(frame, position)
                    } else {
                        running.see(frame, position, step)
                    };
                    self.segments = self.segments + new - gone;
                }
                Entry::Vacant(place) => {
                    place.insert(RunningTrack::new(frame, position));
                    self.seen.pedestrians = self.seen.pedestrians.saturating_add(1);
                }
            }
            if self.segments > self.capacity {
                self.make_room();
            }
        }
        Ok(())
    }

    /// Marks a restart of the camera or its tracker: all tracks end, and frames may begin at any number. The segments
    /// are kept.
    pub fn end_tracks(&mut self) {
        self.end_tracks_that(|_| true);
        self.last_frame = None;
    }

    fn end_tracks_that(&mut self, ends: impl Fn(&RunningTrack) -> bool) {
        let ending = self.running.extract_if(.., |_, running| ends(running));
        let tracks = ending.map(|(_, running)| running.track);
        self.ended.extend(tracks.filter(|track| track.segments() > 0));
    }

    fn make_room(&mut self) {
        let enough = self.capacity - (self.capacity / FORGOTTEN_AT_ONCE).max(1);
        while self.segments > enough && !self.ended.is_empty() {
            self.forget_ended(enough);
        }
        while self.segments > self.capacity {
            let tracks = self.running.values_mut().map(|running| &mut running.track);
            let Some(longest) = tracks.max_by_key(|track| track.segments()) else {
                return;
            };
            self.segments -= longest.forget_oldest();
        }
    }

    /// Removes tracks of the oldest eighth until the number of segments is low enough, first those that newer tracks
    /// repeat.
    fn forget_ended(&mut self, enough: usize) {
        let oldest = self.ended.len().div_ceil(OLDEST);
        for repeated_only in [true, false] {
            for index in 0..oldest {
                if self.segments <= enough {
                    break;
                }
                let [track, newer @ ..] = &mut self.ended[index..] else {
                    break;
                };
                if !repeated_only || track.is_repeated_by(newer) {
                    self.segments -= std::mem::take(track).segments();
                }
            }
        }
        self.ended.retain(|track| track.segments() > 0);
    }
}
