//! Tracks that grow frame by frame, as a tracker on a robot delivers them.

use std::collections::VecDeque;
use std::sync::Arc;

use ddl_core::{OBSERVED, PedestrianId, PedestrianNames, Position, Window, is_finite, is_frame, is_frame_step};
use thiserror::Error;

use crate::completion::Completion;
use crate::recording::Recording;

const NAME: &str = "live";

/// The last positions of all pedestrians, updated one frame at a time.
///
/// After every frame, [`window`](Self::window) is the window that
/// [`Recording::observed_windows`](crate::Recording::observed_windows) would cut from all frames so far and that ends
/// at this frame.
///
/// - Frames may be one step (0.4 s) apart, further apart, or closer together if the tracker is faster.
/// - A pedestrian not seen at one of the 8 steps is not in the window, unless a [`Completion`] is
///   [requested](Self::with_completion).
/// - A pedestrian that is absent for a step (0.4 s) is forgotten; if gaps are filled, one that is absent for longer
///   than the longest gap.
/// - An error changes nothing: the same frame can be pushed again, corrected.
/// - After a frame far ahead, earlier frames are refused; [`clear`](Self::clear) starts again.
///
/// ```
/// use ddl_data::{LiveTracks, PedestrianId};
///
/// let mut tracks = LiveTracks::new(); // frames are counted: 0, 1, 2, ..
/// for frame in 0..7 {
///     assert!(tracks.push(frame, [(PedestrianId(4), [0.5 * frame as f64, 0.0])])?.is_none());
/// }
/// let window = tracks.push(7, [(PedestrianId(4), [3.5, 0.0]), (PedestrianId(2), [9.0, 1.0])])?;
/// let window = window.expect("pedestrian 4 has 8 frames");
/// assert_eq!(window.pedestrians(), [PedestrianId(4)]);
/// assert_eq!(window.observed(0)[7], [3.5, 0.0]);
/// assert_eq!(tracks.len(), 2);
/// # Ok::<(), ddl_data::LiveError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct LiveTracks {
    name: Arc<str>,
    names: PedestrianNames,
    frame_step: i64,
    completion: Completion,
    last_frame: Option<i64>,
    pedestrians: Vec<LivePedestrian>,
}

/// A pedestrian that is in the last frame, or may be in a later window.
#[derive(Debug, Clone, PartialEq)]
struct LivePedestrian {
    id: PedestrianId,
    /// Raw frames and positions, oldest first; never empty.
    seen: VecDeque<(i64, Position)>,
}

impl Default for LiveTracks {
    fn default() -> Self {
        Self::new()
    }
}

#[expect(clippy::len_without_is_empty, reason = "no caller needs is_empty")]
impl LiveTracks {
    /// Empty tracks; consecutive frame numbers are one step of 0.4 s apart.
    #[must_use]
    pub fn new() -> Self {
        Self {
            name: NAME.into(),
            names: PedestrianNames::default(),
            frame_step: 1,
            completion: Completion::NONE,
            last_frame: None,
            pedestrians: Vec::new(),
        }
    }

    /// Empty tracks with another number of raw frames per step of 0.4 s, such as 10 for a camera at 25 frames per
    /// second.
    ///
    /// # Errors
    /// [`LiveError::FrameStep`] if the step is outside 1..=2^31.
    pub fn with_frame_step(frame_step: i64) -> Result<Self, LiveError> {
        if !is_frame_step(frame_step) {
            return Err(LiveError::FrameStep { found: frame_step });
        }
        Ok(Self {
            frame_step,
            ..Self::new()
        })
    }

    pub(crate) fn of(recording: &Recording) -> Self {
        Self {
            name: recording.shared_name(),
            names: recording.names().clone(),
            frame_step: recording.frame_step(),
            ..Self::new()
        }
    }

    /// The same tracks, with incomplete observations filled in as the completion allows.
    #[must_use]
    pub fn with_completion(self, completion: Completion) -> Self {
        Self { completion, ..self }
    }

    /// Forgets all pedestrians and the last frame. Any frame may come next, as after a restart of the tracker.
    pub fn clear(&mut self) {
        self.last_frame = None;
        self.pedestrians.clear();
    }

    /// Raw frames per step of 0.4 s.
    pub fn frame_step(&self) -> i64 {
        self.frame_step
    }

    /// The last frame pushed.
    pub fn last_frame(&self) -> Option<i64> {
        self.last_frame
    }

    /// Number of pedestrians remembered: those of the last frame, and those seen shortly before.
    pub fn len(&self) -> usize {
        self.pedestrians.len()
    }

    /// Adds one frame, with the positions (m) of all pedestrians in any order, and returns the window that ends there.
    /// `None` until a pedestrian has been seen at 8 steps in a row, or as often as the completion requires.
    ///
    /// # Errors
    /// As [`after`](Self::after); the tracks are then unchanged.
    pub fn push(
        &mut self,
        frame: i64,
        positions: impl IntoIterator<Item = (PedestrianId, Position)>,
    ) -> Result<Option<Window>, LiveError> {
        *self = self.after(frame, positions)?;
        Ok(self.window())
    }

    /// A copy of the tracks with one more frame; `self` stays unchanged.
    ///
    /// # Errors
    /// As [`checked_frame`].
    pub fn after(
        &self,
        frame: i64,
        positions: impl IntoIterator<Item = (PedestrianId, Position)>,
    ) -> Result<Self, LiveError> {
        let positions = checked_frame(frame, self.last_frame, positions)?;
        let mut earlier = self.pedestrians.iter().peekable();
        let mut pedestrians = Vec::with_capacity(positions.len());
        for (id, position) in positions {
            while let Some(absent) = earlier.next_if(|pedestrian| pedestrian.id < id) {
                pedestrians.extend(self.remembered(absent, frame));
            }
            let before = earlier.next_if(|pedestrian| pedestrian.id == id);
            let mut pedestrian = before
                .and_then(|pedestrian| self.remembered_before(pedestrian, frame))
                .unwrap_or_else(|| LivePedestrian::unseen(id));
            pedestrian.seen.push_back((frame, position));
            pedestrians.push(pedestrian);
        }
        pedestrians.extend(earlier.filter_map(|absent| self.remembered(absent, frame)));
        Ok(Self {
            name: Arc::clone(&self.name),
            names: self.names.clone(),
            frame_step: self.frame_step,
            completion: self.completion,
            last_frame: Some(frame),
            pedestrians,
        })
    }

    fn remembered(&self, absent: &LivePedestrian, frame: i64) -> Option<LivePedestrian> {
        self.remembered_before(absent, frame + 1)
    }

    /// The observations that may be in the same window as one at `frame`; `None` if there are none.
    fn remembered_before(&self, pedestrian: &LivePedestrian, frame: i64) -> Option<LivePedestrian> {
        let (last, _) = *pedestrian.seen.back()?;
        let gap = self.completion.longest_gap() as i64;
        if frame - last > (gap + 1) * self.frame_step {
            return None;
        }
        // A gap at the start of the window may begin before the window.
        let oldest = frame - (OBSERVED as i64 + gap) * self.frame_step;
        let forgotten = pedestrian.seen.partition_point(|(seen, _)| *seen <= oldest);
        let seen = pedestrian.seen.range(forgotten..).copied().collect();
        let id = pedestrian.id;
        Some(LivePedestrian { id, seen })
    }

    /// The window that ends at the last frame: the pedestrians of that frame that have a position, observed or
    /// completed, at each of the last 8 steps.
    #[must_use]
    pub fn window(&self) -> Option<Window> {
        let last = self.last_frame?;
        let (mut ids, mut positions, mut counts) = (Vec::new(), Vec::new(), Vec::new());
        for pedestrian in self.pedestrians.iter().filter(|pedestrian| pedestrian.is_at(last)) {
            let seen = pedestrian.seen.iter().copied();
            if let Some((observed, missed)) = self.completion.observation(seen, self.frame_step) {
                ids.push(pedestrian.id);
                positions.extend(observed);
                counts.push(missed);
            }
        }
        if ids.is_empty() {
            return None;
        }
        let frames = (1 - OBSERVED as i64..=0).map(|t| last + t * self.frame_step);
        let (step, frames) = (self.frame_step, frames.collect());
        let window = Window::cut(Arc::clone(&self.name), step, frames, ids, positions);
        let names = self.names.clone();
        Some(window.with_names(names).with_completion_counts(counts))
    }
}

impl Recording {
    /// The windows to forecast from: [`OBSERVED`] frames without a future, one window for every frame at which some
    /// pedestrian has been seen for that many steps in a row.
    #[must_use]
    pub fn observed_windows(&self) -> Vec<Window> {
        self.completed_windows(Completion::NONE)
    }

    /// The [`observed_windows`](Self::observed_windows) with incomplete observations filled in as the completion
    /// allows; [`Window::completion_counts`] counts the filled-in positions.
    #[must_use]
    pub fn completed_windows(&self, completion: Completion) -> Vec<Window> {
        let mut tracks = LiveTracks::of(self).with_completion(completion);
        let mut windows = Vec::new();
        for &frame in self.frames() {
            let positions = self.at(frame).iter();
            let positions = positions.map(|seen| (seen.pedestrian, seen.position));
            // Cannot fail: the invariants of a recording exclude every error of live tracks.
            windows.extend(tracks.push(frame, positions).ok().flatten());
        }
        windows
    }
}

impl LivePedestrian {
    fn unseen(id: PedestrianId) -> Self {
        let seen = VecDeque::new();
        Self { id, seen }
    }

    fn is_at(&self, frame: i64) -> bool {
        self.seen.back().is_some_and(|(last, _)| *last == frame)
    }
}

/// Sorts the pedestrians of one frame by id, and checks that the frame may follow the last one (`None`: no frame yet).
///
/// # Errors
/// [`LiveError`] for a frame that is not below 2^53 in size or not after the last, a position that is not finite, or a
/// repeated pedestrian.
pub fn checked_frame(
    frame: i64,
    last: Option<i64>,
    positions: impl IntoIterator<Item = (PedestrianId, Position)>,
) -> Result<Vec<(PedestrianId, Position)>, LiveError> {
    if !is_frame(frame) {
        return Err(LiveError::FrameOutOfRange { frame });
    }
    if let Some(last) = last.filter(|last| frame <= *last) {
        return Err(LiveError::TooEarly { frame, last });
    }
    let mut positions: Vec<(PedestrianId, Position)> = positions.into_iter().collect();
    positions.sort_unstable_by_key(|&(id, _)| id);
    for &(pedestrian, position) in &positions {
        if !is_finite(position) {
            return Err(LiveError::NotFinite {
                pedestrian,
                frame,
                position,
            });
        }
    }
    match positions.windows(2).find(|pair| pair[0].0 == pair[1].0) {
        Some(pair) => Err(LiveError::Duplicate {
            pedestrian: pair[0].0,
            frame,
        }),
        None => Ok(positions),
    }
}

/// A frame that cannot be added to [`LiveTracks`] or to a scene memory, which stay unchanged.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
#[expect(missing_docs, reason = "the messages say what the fields are")]
pub enum LiveError {
    #[error("the frame step must lie in 1..=2^31 raw frames, found {found}")]
    FrameStep { found: i64 },
    #[error("frame {frame} is not below 2^53 in size")]
    FrameOutOfRange { frame: i64 },
    #[error(
        "frame {frame} comes after frame {last}; push frames in order of time, each once; when the tracker restarts, \
         clear the tracks, or end those of the memory, before its first frame"
    )]
    TooEarly { frame: i64, last: i64 },
    #[error("frame {frame}, pedestrian {pedestrian}: {position:?} is not finite")]
    NotFinite {
        pedestrian: PedestrianId,
        frame: i64,
        position: Position,
    },
    #[error("pedestrian {pedestrian} is in frame {frame} twice; keep one position")]
    Duplicate { pedestrian: PedestrianId, frame: i64 },
}
