//! Tracks that grow frame by frame, as a tracker on a robot delivers them.

use thiserror::Error;

use crate::recording::{FRAME_LIMIT, FRAME_STEP_LIMIT};
use crate::{OBSERVED, PedestrianId, Position, Window};

/// What windows of live tracks name as their recording.
const NAME: &str = "live";

/// Everybody's last positions, fed one frame at a time.
///
/// After every frame, [`window`](Self::window) is the one that [`Recording::observed_windows`](crate::Recording::observed_windows) would
/// cut from all frames so far and that ends at this frame: whoever was seen in each of the last 8 frames, 0.4 s apart, with the same
/// numbers in the same order.
///
/// - A frame comes at least one step (0.4 s) after the one before; anything earlier is an error.
/// - After a *gap*, a frame later than one step, everybody starts anew: nothing is filled in.
/// - Whoever is missing in a frame, also in an empty one, is forgotten, and starts anew when seen again. So what is kept is
///   bounded by the people of the last frame, 8 positions each.
/// - After an error nothing has changed: the same frame can be pushed again, corrected.
/// - A frame far ahead is a gap too, and earlier ones come too early then: [`clear`](Self::clear) starts anew.
///
/// ```
/// use ddl_data::{LiveTracks, PedestrianId};
///
/// let mut tracks = LiveTracks::new(); // frames are counted: 0, 1, 2, ..
/// for frame in 0..7 {
///     assert!(tracks.push(frame, [(PedestrianId(4), [0.5 * frame as f64, 0.0])])?.is_none());
/// }
/// let window = tracks.push(7, [(PedestrianId(4), [3.5, 0.0]), (PedestrianId(2), [9.0, 1.0])])?;
/// let window = window.expect("walker 4 has 8 frames");
/// assert_eq!(window.pedestrians(), [PedestrianId(4)]);
/// assert_eq!(window.observed(0)[7], [3.5, 0.0]);
/// assert_eq!(tracks.len(), 2);
/// # Ok::<(), ddl_data::LiveError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct LiveTracks {
    frame_step: i64,
    last_frame: Option<i64>,
    /// Those in the last frame, by id.
    walkers: Vec<Walker>,
}

/// Somebody who is in the last frame.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Walker {
    id: PedestrianId,
    /// Frames in a row up to the last, at most 8.
    seen: usize,
    /// The last `seen` of these, oldest first; the others mean nothing.
    positions: [Position; OBSERVED],
}

impl Default for LiveTracks {
    fn default() -> Self {
        Self::new()
    }
}

impl LiveTracks {
    /// Nobody seen yet; frames are counted, so that one step of 0.4 s is from one number to the next.
    #[must_use]
    pub fn new() -> Self {
        Self {
            frame_step: 1,
            last_frame: None,
            walkers: Vec::new(),
        }
    }

    /// Nobody seen yet, with another number of raw frames in a step of 0.4 s, such as 10 of a camera at 25 frames a second.
    ///
    /// # Errors
    /// [`LiveError::FrameStep`] if the step does not lie in 1..=2^31.
    pub fn with_frame_step(frame_step: i64) -> Result<Self, LiveError> {
        if !(1..=FRAME_STEP_LIMIT).contains(&frame_step) {
            return Err(LiveError::FrameStep { found: frame_step });
        }
        Ok(Self {
            frame_step,
            ..Self::new()
        })
    }

    /// Forgets everybody and the last frame: any frame may come next, as when a tracker starts anew.
    pub fn clear(&mut self) {
        self.last_frame = None;
        self.walkers.clear();
    }

    /// Raw frames in one step of 0.4 s.
    pub fn frame_step(&self) -> i64 {
        self.frame_step
    }

    /// The last frame pushed.
    pub fn last_frame(&self) -> Option<i64> {
        self.last_frame
    }

    /// People in the last frame, which is as many as are remembered.
    pub fn len(&self) -> usize {
        self.walkers.len()
    }

    /// Whether nobody is remembered.
    pub fn is_empty(&self) -> bool {
        self.walkers.is_empty()
    }

    /// Adds one frame, everybody's positions (m) in any order, and gives the window that ends there; `None` while nobody has
    /// been seen for 8 frames in a row.
    ///
    /// # Errors
    /// As [`after`](Self::after); nothing has changed then.
    pub fn push(
        &mut self,
        frame: i64,
        people: impl IntoIterator<Item = (PedestrianId, Position)>,
    ) -> Result<Option<Window>, LiveError> {
        *self = self.after(frame, people)?;
        Ok(self.window())
    }

    /// The tracks with one frame more, leaving these as they are.
    ///
    /// # Errors
    /// [`LiveError`] for a frame out of range or less than one step after the last, a position that is not finite, or
    /// somebody twice.
    pub fn after(
        &self,
        frame: i64,
        people: impl IntoIterator<Item = (PedestrianId, Position)>,
    ) -> Result<Self, LiveError> {
        if frame.unsigned_abs() >= FRAME_LIMIT.unsigned_abs() {
            return Err(LiveError::FrameOutOfRange { frame });
        }
        let due = self.last_frame.map(|last| last + self.frame_step);
        if let (Some(last), Some(due)) = (self.last_frame, due)
            && frame < due
        {
            return Err(LiveError::TooEarly { frame, last, due });
        }
        let mut people: Vec<(PedestrianId, Position)> = people.into_iter().collect();
        people.sort_unstable_by_key(|&(id, _)| id);
        for &(pedestrian, position) in &people {
            if !position.iter().all(|c| c.is_finite()) {
                return Err(LiveError::NotFinite {
                    pedestrian,
                    frame,
                    position,
                });
            }
        }
        if let Some(pair) = people.windows(2).find(|pair| pair[0].0 == pair[1].0) {
            let pedestrian = pair[0].0;
            return Err(LiveError::Duplicate { pedestrian, frame });
        }
        let known: &[Walker] = if due == Some(frame) {
            &self.walkers
        } else {
            &[]
        };
        let mut earlier = known.iter().peekable();
        let walkers = people
            .into_iter()
            .map(|(id, position)| {
                while earlier.next_if(|walker| walker.id < id).is_some() {}
                match earlier.next_if(|walker| walker.id == id) {
                    Some(walker) => walker.moved_to(position),
                    None => Walker::new(id, position),
                }
            })
            .collect();
        Ok(Self {
            frame_step: self.frame_step,
            last_frame: Some(frame),
            walkers,
        })
    }

    /// The window that ends at the last frame, of everybody seen in each of the last 8; `None` when that is nobody.
    #[must_use]
    pub fn window(&self) -> Option<Window> {
        let last = self.last_frame?;
        let whole: Vec<&Walker> = self.walkers.iter().filter(|w| w.seen == OBSERVED).collect();
        if whole.is_empty() {
            return None;
        }
        let frames = (1 - OBSERVED as i64..=0).map(|t| last + t * self.frame_step);
        Some(Window::cut(
            NAME.into(),
            self.frame_step,
            frames.collect(),
            whole.iter().map(|walker| walker.id).collect(),
            whole.iter().flat_map(|walker| walker.positions).collect(),
        ))
    }
}

impl Walker {
    /// Somebody seen for the first time.
    fn new(id: PedestrianId, position: Position) -> Self {
        Self {
            id,
            seen: 1,
            positions: [position; OBSERVED],
        }
    }

    /// The same one step later.
    fn moved_to(mut self, position: Position) -> Self {
        self.positions.rotate_left(1);
        self.positions[OBSERVED - 1] = position;
        self.seen = (self.seen + 1).min(OBSERVED);
        self
    }
}

/// Why a frame cannot be added to [`LiveTracks`], which are then as they were.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum LiveError {
    /// The frame step is not positive, or absurdly large.
    #[error("the frame step must lie in 1..=2^31 raw frames, found {found}")]
    FrameStep {
        /// The step given.
        found: i64,
    },
    /// A frame number too large to count on from.
    #[error("frame {frame} is not below 2^53 in size")]
    FrameOutOfRange {
        /// The raw frame number.
        frame: i64,
    },
    /// A frame that goes back in time, or comes less than 0.4 s after the last one.
    #[error(
        "frame {frame} comes too early: the last one was {last}, the next one 0.4 s later is {due}; leave frames in between \
         out, give another frame step, or clear the tracks when the tracker starts anew"
    )]
    TooEarly {
        /// The raw frame number.
        frame: i64,
        /// That of the frame before.
        last: i64,
        /// The earliest one allowed.
        due: i64,
    },
    /// A coordinate is infinite or NaN.
    #[error("frame {frame}, pedestrian {pedestrian}: {position:?} is not finite")]
    NotFinite {
        /// The pedestrian.
        pedestrian: PedestrianId,
        /// The raw frame number.
        frame: i64,
        /// The position (m).
        position: Position,
    },
    /// One pedestrian twice in one frame.
    #[error("pedestrian {pedestrian} is in frame {frame} twice; keep one")]
    Duplicate {
        /// The pedestrian.
        pedestrian: PedestrianId,
        /// The raw frame number.
        frame: i64,
    },
}
