//! Tracks that grow frame by frame, as a tracker on a robot delivers them.

use std::collections::BTreeMap;
use std::collections::btree_map::Entry;
use std::sync::Arc;

use ddl_core::{OBSERVED, OtherObservation, PedestrianId, PedestrianNames, Position, TIME_STEP, Window, is_frame};

use crate::clock::{Clock, ClockError};
use crate::error::LiveError;
use crate::observe::{
    self, Exchange, Misfit, ON_STEP, ObservedPositions, ObservedTrack, RecordingNoise, TimedPosition,
};
use crate::recording::Recording;

const NAME: &str = "live";
/// Largest number of pedestrians of a stream seen within 2 s, above that of any crowd.
const MOST_PEDESTRIANS: usize = 200_000;
/// Pedestrians have common frames if at most so many frames with one of them come on each with several: trackers lose
/// rows.
const COMMON: u64 = 4;

/// Which pedestrians are observed well enough for a window.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Completeness {
    /// Those tracked for all 8 steps: the first is 2.8 s old.
    Whole,
    /// All, from their first row on; earlier positions continue their motion backwards.
    Partial,
}

impl Completeness {
    /// Only those tracked for all 8 steps, or all.
    #[must_use]
    pub fn of(only_whole: bool) -> Self {
        if only_whole { Self::Whole } else { Self::Partial }
    }
}

/// The tracks of all pedestrians up to the last frame.
///
/// After every frame, [`window`](Self::window) holds what was observed up to then, and nothing later: for each
/// pedestrian 8 positions, at the frame and every 0.4 s before. Rows of a pedestrian at these times pass unchanged.
/// Otherwise the positions are estimated from all its rows so far: a Kalman filter and smoother of a motion with random
/// accelerations, whose noise is [measured](Self::noise).
///
/// - Each pedestrian has its own clock: rows may come at any times, also at other times than those of other
///   pedestrians.
/// - A pedestrian whose last row is not [too old](Self::with_max_age) is carried on to the frame.
/// - A position too far from the expected one is left out, and [reported](Self::misfits). If the next rows agree with
///   it, the track begins anew there, and also after 2 s without a row.
/// - A position that people seldom reach has two explanations until the next row: the window holds the likelier one,
///   and [the other](Window::other).
/// - Pedestrians who exchange their ids go on under the new ones.
/// - A pedestrian without a row for 2 s is forgotten.
/// - An error changes nothing: the same frame can be pushed again, corrected.
/// - After a frame far ahead, earlier frames are refused; [`clear`](Self::clear) starts again.
///
/// ```
/// use ddl_core::PedestrianId;
/// use ddl_data::LiveTracks;
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
    clock: Clock,
    completeness: Completeness,
    /// In ticks; `None` for a step, or the time between the last rows of a pedestrian if that is longer.
    max_age: Option<f64>,
    /// Least time between two windows, in ticks; `None` for windows at common frames, or every step.
    interval: Option<f64>,
    /// Whether windows hold other explanations of doubtful rows.
    are_rows_doubted: bool,
    /// The last frame number pushed, and its tick.
    last_number: Option<i64>,
    last_frame: Option<i64>,
    /// Whether there is a window at the last frame.
    is_moment: bool,
    /// Tick from which on there is the next window.
    next_moment: f64,
    /// Number of frames with rows of several pedestrians, and of one, where several were seen within a step.
    frames_of_several: u64,
    frames_of_one: u64,
    noise: RecordingNoise,
    /// Shared between copies of the tracks, because a frame may change only some.
    pedestrians: BTreeMap<PedestrianId, Arc<LivePedestrian>>,
    misfits: Vec<Misfit>,
    /// Largest number of pedestrians seen within 2 s.
    most_pedestrians: usize,
}

/// A pedestrian seen within the last 2 s.
#[derive(Debug, Clone, PartialEq)]
struct LivePedestrian {
    /// Tick of its last row, wrong or not.
    last_row: i64,
    track: ObservedTrack,
}

impl Default for LiveTracks {
    fn default() -> Self {
        Self::new()
    }
}

#[expect(clippy::len_without_is_empty, reason = "no caller needs is_empty")]
impl LiveTracks {
    /// Time without a row (s) after which a track begins anew: no age or interval is longer.
    pub const LONGEST_GAP: f64 = observe::LONGEST_GAP;

    /// Empty tracks; consecutive frame numbers are one step of 0.4 s apart. Windows hold only
    /// [whole](Completeness::Whole) observations.
    #[must_use]
    pub fn new() -> Self {
        Self::with_clock(Clock::STEPS)
    }

    /// Empty tracks whose frames are counted by this clock.
    #[must_use]
    pub fn with_clock(clock: Clock) -> Self {
        Self {
            name: NAME.into(),
            names: PedestrianNames::default(),
            clock,
            completeness: Completeness::Whole,
            max_age: None,
            interval: Some(0.0),
            are_rows_doubted: true,
            last_number: None,
            last_frame: None,
            is_moment: false,
            next_moment: f64::NEG_INFINITY,
            frames_of_several: 0,
            frames_of_one: 0,
            noise: RecordingNoise::default(),
            pedestrians: BTreeMap::new(),
            misfits: Vec::new(),
            most_pedestrians: MOST_PEDESTRIANS,
        }
    }

    /// Empty tracks with another number of raw frames per step of 0.4 s, such as 10 for a camera at 25 frames per
    /// second.
    ///
    /// # Errors
    /// [`ClockError::FrameStep`] if the step is outside 1..=2^31.
    pub fn with_frame_step(frame_step: i64) -> Result<Self, ClockError> {
        Ok(Self::with_clock(Clock::with_frame_step(frame_step)?))
    }

    pub(crate) fn of_recording(recording: &Recording) -> Self {
        Self {
            name: recording.shared_name(),
            names: recording.names().clone(),
            interval: None,
            // A file is in memory already.
            most_pedestrians: usize::MAX,
            ..Self::with_clock(Clock::of_ticks(recording.frame_step()))
        }
    }

    /// The same tracks, with windows of the pedestrians observed so well.
    #[must_use]
    pub fn with_completeness(self, completeness: Completeness) -> Self {
        Self { completeness, ..self }
    }

    /// How well the pedestrians of a window are observed.
    pub fn completeness(&self) -> Completeness {
        self.completeness
    }

    /// The same tracks, in which pedestrians are carried on until their last row is so old (s). `None` changes nothing:
    /// the age is 0.4 s, or the time between the last rows of a pedestrian if that is longer. NaN and negative numbers
    /// count as 0: only pedestrians of the frame itself.
    #[must_use]
    pub fn with_max_age(self, seconds: impl Into<Option<f64>>) -> Self {
        let max_age = seconds.into().map(|seconds| self.ticks(seconds)).or(self.max_age);
        Self { max_age, ..self }
    }

    /// The same tracks, with windows so long apart (s), on the mean; 0 for one at every frame. `None` changes nothing.
    #[must_use]
    pub fn with_interval(self, seconds: impl Into<Option<f64>>) -> Self {
        let ticks = seconds.into().map(|seconds| self.ticks(seconds));
        // Less than a tick is every frame.
        let interval = ticks.map(|ticks| if ticks < 1.0 { 0.0 } else { ticks }).or(self.interval);
        Self { interval, ..self }
    }

    /// The same tracks, whose windows hold every row that is not left out as a fact.
    #[must_use]
    pub(crate) fn without_doubt(self) -> Self {
        Self { are_rows_doubted: false, ..self }
    }

    /// Whether frames show several pedestrians, or each pedestrian has a clock of its own, by the frames so far.
    pub fn have_common_frames(&self) -> bool {
        COMMON * self.frames_of_several >= self.frames_of_one
    }

    fn ticks(&self, seconds: f64) -> f64 {
        seconds.max(0.0) / TIME_STEP * self.clock.frame_step() as f64
    }

    /// Forgets all pedestrians and the last frame. Any frame may come next, as after a restart of the tracker.
    pub fn clear(&mut self) {
        self.last_number = None;
        self.last_frame = None;
        self.is_moment = false;
        self.next_moment = f64::NEG_INFINITY;
        self.pedestrians.clear();
        self.misfits.clear();
    }

    /// Adds names of pedestrians, also of those in the next frame; those of forgotten pedestrians go.
    pub fn name(&mut self, names: &PedestrianNames) {
        self.names = self.names.updated(names, |id| self.pedestrians.contains_key(&id));
    }

    /// The names of its pedestrians.
    pub fn names(&self) -> &PedestrianNames {
        &self.names
    }

    /// How frames are counted.
    pub fn clock(&self) -> Clock {
        self.clock
    }

    /// The tick of the last frame pushed.
    pub fn last_frame(&self) -> Option<i64> {
        self.last_frame
    }

    /// Number of pedestrians remembered: those seen within the last 2 s.
    pub fn len(&self) -> usize {
        self.pedestrians.len()
    }

    /// How exact the positions are, as measured so far.
    pub fn noise(&self) -> &RecordingNoise {
        &self.noise
    }

    /// Whether the last row of a pedestrian was left out, or is rather wrong than right.
    pub fn has_left_out(&self, id: PedestrianId) -> bool {
        let is_wrong = |one: &LivePedestrian| one.track.otherwise().is_some_and(|(.., is_likelier)| is_likelier);
        self.pedestrians.get(&id).is_some_and(|one| one.track.last_time() < one.last_row as f64 || is_wrong(one))
    }

    /// The rows that the last frame showed to be wrong, and the tracks that it began anew.
    pub fn misfits(&self) -> &[Misfit] {
        &self.misfits
    }

    /// Whether there is a window at the last frame, if a pedestrian is observed well enough.
    pub fn is_moment(&self) -> bool {
        self.is_moment
    }

    /// Adds one frame, with the positions (m) of all pedestrians in any order, and returns the window that ends there.
    /// `None` without a pedestrian that is observed well enough, or too soon after the last window.
    ///
    /// # Errors
    /// As [`checked_frame`], for a frame number that the clock cannot divide, and for more than 200,000 pedestrians
    /// within 2 s; the tracks are then unchanged.
    pub fn push(
        &mut self,
        frame: i64,
        positions: impl IntoIterator<Item = (PedestrianId, Position)>,
    ) -> Result<Option<Window>, LiveError> {
        let positions = checked_frame(frame, self.last_number, positions)?;
        let tick = self.clock.tick(frame)?;
        self.ensure_room(tick, &positions)?;
        (self.last_number, self.last_frame) = (Some(frame), Some(tick));
        self.misfits.clear();
        let (tick_time, rows) = (self.tick_time(), positions.len());
        let exchanges = self.exchanges(tick as f64, &positions);
        for (id, position) in positions {
            let time = tick as f64;
            match self.pedestrians.entry(id) {
                Entry::Vacant(place) => {
                    let track = ObservedTrack::beginning(time, position);
                    place.insert(Arc::new(LivePedestrian { last_row: tick, track }));
                }
                Entry::Occupied(mut place) => {
                    let pedestrian = Arc::make_mut(place.get_mut());
                    pedestrian.last_row = tick;
                    let row = TimedPosition { time, position };
                    let exchange = exchanges.iter().find(|(exchange, _)| exchange.id == id);
                    let misfit = match exchange.cloned() {
                        Some((exchange, track)) => {
                            pedestrian.track.exchange(track, exchange, row, tick_time, &mut self.noise)
                        }
                        None => pedestrian.track.push(row, tick_time, &mut self.noise),
                    };
                    pedestrian.track.forget_before(time, self.clock.frame_step() as f64);
                    self.misfits.extend(misfit.map(|(time, distance, treatment)| Misfit {
                        tick: time as i64,
                        pedestrian: id,
                        distance,
                        treatment,
                    }));
                }
            }
        }
        let mut pedestrians = std::mem::take(&mut self.pedestrians);
        pedestrians.retain(|_, pedestrian| !self.is_gone(pedestrian, tick));
        self.pedestrians = pedestrians;
        self.decide_moment(tick, rows);
        Ok(self.window())
    }

    /// Those of these pedestrians who exchanged their ids, or may have, with the track that each goes on from.
    fn exchanges(&self, time: f64, positions: &[(PedestrianId, Position)]) -> Vec<(Exchange, ObservedTrack)> {
        let track = |id: &PedestrianId| Some(&self.pedestrians.get(id)?.track);
        let rows = positions.iter().filter_map(|&(id, position)| {
            let expected = track(&id)?.expectation(time, self.tick_time())?;
            Some((id, position, expected))
        });
        let exchanges = observe::exchanges(rows).into_iter();
        exchanges.filter_map(|exchange| Some((exchange, track(&exchange.from)?.clone()))).collect()
    }

    /// Memory is bounded, also if every row has another pedestrian.
    fn ensure_room(&self, tick: i64, positions: &[(PedestrianId, Position)]) -> Result<(), LiveError> {
        if self.pedestrians.len().saturating_add(positions.len()) <= self.most_pedestrians {
            return Ok(());
        }
        let is_known = |id: &PedestrianId| self.pedestrians.get(id).is_some_and(|known| !self.is_gone(known, tick));
        let new = positions.iter().filter(|(id, _)| !is_known(id)).count();
        let kept = self.pedestrians.values().filter(|pedestrian| !self.is_gone(pedestrian, tick));
        if kept.count() + new <= self.most_pedestrians {
            return Ok(());
        }
        Err(LiveError::TooManyPedestrians { limit: self.most_pedestrians })
    }

    /// Whether a pedestrian is forgotten at this tick.
    fn is_gone(&self, pedestrian: &LivePedestrian, tick: i64) -> bool {
        (tick - pedestrian.last_row) as f64 * self.tick_time() > Self::LONGEST_GAP
    }

    /// The window as if its pedestrians had been observed only for the last `rows` of its 8 steps, 1 to 8.
    #[must_use]
    pub fn last_rows(window: &Window, rows: usize) -> Window {
        let mut tracks = Self::new().with_completeness(Completeness::Partial).without_doubt();
        for step in OBSERVED.saturating_sub(rows.max(1))..OBSERVED {
            // Cannot fail: the positions of a window are those of a frame.
            let _ = tracks.push(step as i64, window.pedestrians().iter().copied().zip(window.positions_at(step)));
        }
        let Some(seen) = tracks.window() else { return window.clone() };
        // Its pedestrians are in the order of their ids.
        let place = |i: usize| seen.pedestrians().binary_search(&window.pedestrians()[i]);
        let position = |i: usize, step: usize, position| match place(i) {
            Ok(place) if step < OBSERVED => seen.observed(place)[step],
            _ => position,
        };
        let qualities = (0..window.len()).map(|i| place(i).map_or(window.quality(i), |place| seen.quality(place)));
        let bystanders = window.bystanders().map(|window| Self::last_rows(window, rows));
        window.map_positions(position).with_qualities(qualities.collect()).with_bystanders(bystanders)
    }

    /// A copy of the tracks with one more frame; `self` stays unchanged.
    ///
    /// # Errors
    /// As [`push`](Self::push).
    pub fn after(
        &self,
        frame: i64,
        positions: impl IntoIterator<Item = (PedestrianId, Position)>,
    ) -> Result<Self, LiveError> {
        let mut next = self.clone();
        next.push(frame, positions)?;
        Ok(next)
    }

    /// Decides whether there is a window at this tick, which has so many rows.
    fn decide_moment(&mut self, tick: i64, rows: usize) {
        let step = self.clock.frame_step();
        if self.pedestrians.values().filter(|pedestrian| tick - pedestrian.last_row < step).count() > 1 {
            self.frames_of_several += u64::from(rows > 1);
            self.frames_of_one += u64::from(rows == 1);
        }
        let interval = self.interval.unwrap_or(if self.have_common_frames() { 0.0 } else { step as f64 });
        // How late the frame is for the next window; a clock may jitter.
        let late = tick as f64 - self.next_moment + ON_STEP * step as f64;
        self.is_moment = interval == 0.0 || late >= 0.0;
        if self.is_moment && interval > 0.0 && late < f64::INFINITY {
            // A late frame does not shift the windows after it.
            self.next_moment += interval * ((late / interval).floor() + 1.0);
        } else if self.is_moment {
            self.next_moment = tick as f64 + self.interval.unwrap_or(step as f64);
        }
    }

    fn tick_time(&self) -> f64 {
        TIME_STEP / self.clock.frame_step() as f64
    }

    /// The window that ends at the last frame: the pedestrians observed well enough; `None` if there are none, or too
    /// soon after the last window.
    #[must_use]
    pub fn window(&self) -> Option<Window> {
        let last = self.last_frame.filter(|_| self.is_moment)?;
        let (time, step) = (last as f64, self.clock.frame_step());
        let (mut ids, mut positions, mut qualities, mut others) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        for (id, pedestrian) in &self.pedestrians {
            let LivePedestrian { last_row, track } = pedestrian.as_ref();
            let age = time - track.last_time();
            let max_age = self.max_age.unwrap_or_else(|| track.usual_interval().max(step as f64));
            // A wrong position says that the pedestrian is there.
            let is_present = *last_row == last || age < max_age;
            let observed = |track: &ObservedTrack| track.observed(time, step as f64, self.tick_time());
            if is_present
                && let Some((observed, other)) = self.explained(track, observed)
                && (self.completeness == Completeness::Partial || observed.quality.is_whole())
            {
                others.extend(other.map(|other| (ids.len(), other)));
                ids.push(*id);
                positions.extend(observed.positions);
                qualities.push(observed.quality);
            }
        }
        if ids.is_empty() {
            return None;
        }
        let frames = (1 - OBSERVED as i64..=0).map(|t| last + t * step).collect();
        let window = Window::cut(Arc::clone(&self.name), step, frames, ids, positions);
        Some(window.with_names(self.names.clone()).with_qualities(qualities).with_others(others))
    }

    /// The likelier explanation of a track, and the other one if its last row is doubtful.
    fn explained(
        &self,
        track: &ObservedTrack,
        observed: impl Fn(&ObservedTrack) -> Option<ObservedPositions>,
    ) -> Option<(ObservedPositions, Option<OtherObservation>)> {
        let mut likelier = observed(track)?;
        let without = if self.are_rows_doubted { track.otherwise() } else { None };
        let other = without.and_then(|(track, mut weight, is_likelier)| {
            let mut other = observed(track)?;
            if is_likelier {
                std::mem::swap(&mut likelier, &mut other);
                weight = 1.0 - weight;
            }
            let ObservedPositions { positions, quality } = other;
            Some(OtherObservation { positions, quality, weight })
        });
        Some((likelier, other))
    }
}

/// Sorts the pedestrians of one frame by id, and checks that the frame may follow the last one (`None`: no frame yet).
///
/// # Errors
/// [`LiveError`] for a frame that is not below 2^53 in size or not after the last, a position that is not finite or too
/// far away, or a repeated pedestrian.
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
        LiveError::check_row(frame, pedestrian, position)?;
    }
    match positions.windows(2).find(|pair| pair[0].0 == pair[1].0) {
        Some(pair) => Err(LiveError::Duplicate { pedestrian: pair[0].0, frame }),
        None => Ok(positions),
    }
}
