//! A recording: the positions of all pedestrians of one scene over time.

use std::collections::{BTreeMap, HashMap};
use std::ops::Range;
use std::sync::Arc;

use ddl_core::{PedestrianId, PedestrianNames, is_frame_step};

use crate::clock::{Clock, ClockError, TimeUnit};
use crate::error::{LiveError, RecordingError};
use crate::observation::Observation;

/// Spacing of the rows of a pedestrian (s) above which they no longer show the course of a track.
const SLOWEST: f64 = 1.2;
/// Closer rows of a pedestrian (s) show that times do not count seconds.
const FASTEST: f64 = 1e-3;

/// All observations of one scene, sorted by frame and then by pedestrian.
///
/// Invariants: at least one observation, every position finite and within
/// [`COORDINATE_LIMIT`](ddl_core::COORDINATE_LIMIT), at most one observation per pedestrian and frame, a positive frame
/// step.
#[derive(Debug, Clone, PartialEq)]
pub struct Recording {
    name: Arc<str>,
    frame_step: i64,
    pub(crate) observations: Vec<Observation>,
    frames: Vec<i64>,
    /// `starts[k]..starts[k + 1]` are the observations of `frames[k]`.
    starts: Vec<usize>,
    pub(crate) rate: Option<f64>,
    time_unit: Option<TimeUnit>,
    /// How often the frame numbers begin again in the file.
    pub(crate) restarts: usize,
    pub(crate) notes: Vec<String>,
    names: PedestrianNames,
}

impl Recording {
    /// Creates a recording from observations in any order.
    ///
    /// `frame_step` is the number of raw frames per step of [`TIME_STEP`](ddl_core::TIME_STEP) seconds.
    ///
    /// # Errors
    /// If there are no observations, the frame step is outside 1..=2^31, a frame is 2^53 or more in size, a position is
    /// not finite, or a pedestrian is in a frame twice.
    pub fn new(
        name: impl Into<Arc<str>>,
        frame_step: i64,
        mut observations: Vec<Observation>,
    ) -> Result<Self, RecordingError> {
        if !is_frame_step(frame_step) {
            return Err(RecordingError::FrameStep { found: frame_step });
        }
        if observations.is_empty() {
            return Err(RecordingError::Empty);
        }
        for &Observation { frame, pedestrian, position } in &observations {
            LiveError::check_row(frame, pedestrian, position)?;
        }
        observations.sort_unstable_by_key(|o| (o.frame, o.pedestrian));
        if let Some(pair) =
            observations.windows(2).find(|w| (w[0].frame, w[0].pedestrian) == (w[1].frame, w[1].pedestrian))
        {
            let Observation { frame, pedestrian, .. } = pair[0];
            return Err(LiveError::Duplicate { pedestrian, frame }.into());
        }
        let mut frames = Vec::new();
        let mut starts = Vec::new();
        for (index, observation) in observations.iter().enumerate() {
            if frames.last() != Some(&observation.frame) {
                frames.push(observation.frame);
                starts.push(index);
            }
        }
        starts.push(observations.len());
        Ok(Self {
            name: name.into(),
            frame_step,
            observations,
            frames,
            starts,
            rate: None,
            time_unit: None,
            restarts: 0,
            notes: Vec::new(),
            names: PedestrianNames::default(),
        })
    }

    /// Creates a recording whose frame step is the most common difference between successive rows of a pedestrian (the
    /// smaller of two equally common ones; 1 if no pedestrian has two rows).
    ///
    /// # Errors
    /// As [`Recording::new`].
    pub fn in_usual_step(name: impl Into<Arc<str>>, observations: Vec<Observation>) -> Result<Self, RecordingError> {
        let recording = Self::new(name, 1, observations)?;
        let mut counts = BTreeMap::<i64, usize>::new();
        for difference in recording.differences() {
            if is_frame_step(difference) {
                *counts.entry(difference).or_default() += 1;
            }
        }
        // Ascending by difference; `max_by_key` keeps the last of equal counts, hence reversed.
        let usual = counts.into_iter().rev().max_by_key(|&(_, count)| count);
        let frame_step = usual.map_or(1, |(difference, _)| difference);
        Ok(Self { frame_step, ..recording })
    }

    /// The differences of frame numbers between successive rows of each pedestrian.
    pub(crate) fn differences(&self) -> Vec<i64> {
        let mut last_frames = HashMap::new();
        let rows = self.observations.iter();
        rows.filter_map(|row| Some(row.frame - last_frames.insert(row.pedestrian, row.frame)?)).collect()
    }

    /// Median difference of frame numbers between successive rows of a pedestrian; `None` if no pedestrian has two.
    pub(crate) fn usual_spacing(&self) -> Option<i64> {
        let mut differences = self.differences();
        differences.sort_unstable();
        differences.get(differences.len() / 2).copied()
    }

    /// The recording in ticks of a clock, of which [`frame_step`](Self::frame_step) make 0.4 s.
    ///
    /// # Errors
    /// [`ClockError`] where frame numbers are too large, or the rows of a pedestrian are more than 1.2 s or less than
    /// 1 ms apart.
    pub fn on_clock(&self, clock: Clock) -> Result<Self, ClockError> {
        let apart = self.usual_spacing().unwrap_or(0) as f64 / clock.frames_a_second();
        if apart > SLOWEST {
            return Err(ClockError::TooSlow { apart });
        }
        if apart > 0.0 && apart < FASTEST {
            return Err(ClockError::TooFast { apart });
        }
        let mut recording = Self { frame_step: clock.frame_step(), ..self.clone() };
        for frame in &mut recording.frames {
            *frame = clock.tick(*frame)?;
        }
        for row in &mut recording.observations {
            row.frame = clock.tick(row.frame)?;
        }
        Ok(recording)
    }

    /// The clock that the file states: its time stamps, or its [`rate`](Self::rate).
    ///
    /// # Errors
    /// [`ClockError`] for a rate that is out of range.
    pub fn stated_clock(&self) -> Option<Result<Clock, ClockError>> {
        match self.time_unit {
            Some(unit) => Some(Ok(Clock::with_stamps(unit))),
            None => Some(Clock::with_frame_time(self.stated_frame_time()?)),
        }
    }

    /// Seconds per frame number according to the [`rate`](Self::rate) of the file.
    pub fn stated_frame_time(&self) -> Option<f64> {
        Some(1.0 / (self.rate? * self.frame_step as f64))
    }

    /// What its column of times counts; `None` for frame numbers.
    pub fn time_unit(&self) -> Option<TimeUnit> {
        self.time_unit
    }

    /// The same recording, whose frame numbers are times in microseconds that its columns count in this unit; `None`
    /// for frame numbers.
    #[must_use]
    pub fn with_time_unit(self, time_unit: Option<TimeUnit>) -> Self {
        let frame_step = time_unit.map_or(self.frame_step, |unit| Clock::with_stamps(unit).frame_step());
        Self { frame_step, time_unit, ..self }
    }

    /// What was assumed while the file was read, a sentence each.
    pub fn notes(&self) -> &[String] {
        &self.notes
    }

    /// The same recording with [`notes`](Self::notes).
    #[must_use]
    pub fn with_notes(self, notes: Vec<String>) -> Self {
        Self { notes, ..self }
    }

    /// The same recording, whose rows were not in the order of their times: how often these begin again.
    #[must_use]
    pub fn with_restarts(self, restarts: usize) -> Self {
        Self { restarts, ..self }
    }

    pub(crate) fn with_names(self, names: PedestrianNames) -> Self {
        Self { names, ..self }
    }

    /// The same recording, with these words as names of its pedestrians.
    #[must_use]
    pub fn with_words(self, words: BTreeMap<PedestrianId, Arc<str>>) -> Self {
        self.with_names(PedestrianNames::new(words))
    }

    /// The names of the pedestrians in the file.
    pub fn names(&self) -> &PedestrianNames {
        &self.names
    }

    /// Rows of a pedestrian per second, if the file states it: in TrajNet++ scenes, in a comment, or by its format.
    pub fn rate(&self) -> Option<f64> {
        self.rate
    }

    /// The same recording under another name.
    #[must_use]
    pub fn with_name(mut self, name: impl Into<Arc<str>>) -> Self {
        self.name = name.into();
        self
    }

    /// The same recording with another number of raw frames per step.
    ///
    /// # Errors
    /// If the step is outside 1..=2^31.
    pub fn with_frame_step(mut self, frame_step: i64) -> Result<Self, RecordingError> {
        if !is_frame_step(frame_step) {
            return Err(RecordingError::FrameStep { found: frame_step });
        }
        self.frame_step = frame_step;
        Ok(self)
    }

    /// The recording's name, such as `zara01`.
    pub fn name(&self) -> &str {
        &self.name
    }

    pub(crate) fn shared_name(&self) -> Arc<str> {
        Arc::clone(&self.name)
    }

    /// Raw frames per step of 0.4 s.
    pub fn frame_step(&self) -> i64 {
        self.frame_step
    }

    /// Every observation, sorted by frame, then by pedestrian.
    pub fn observations(&self) -> &[Observation] {
        &self.observations
    }

    /// The annotated frames: raw frame numbers with at least one observation, ascending.
    pub fn frames(&self) -> &[i64] {
        &self.frames
    }

    /// The observations at a raw frame, sorted by pedestrian; empty if the frame is not annotated.
    pub fn at(&self, frame: i64) -> &[Observation] {
        &self.observations[self.range_at(frame)]
    }

    pub(crate) fn tracks(&self) -> BTreeMap<PedestrianId, Vec<&Observation>> {
        let mut tracks: BTreeMap<PedestrianId, Vec<&Observation>> = BTreeMap::new();
        for seen in &self.observations {
            tracks.entry(seen.pedestrian).or_default().push(seen);
        }
        tracks
    }

    pub(crate) fn range_at(&self, frame: i64) -> Range<usize> {
        match self.frames.binary_search(&frame) {
            Ok(index) => self.range_of(index),
            Err(_) => 0..0,
        }
    }

    pub(crate) fn range_of(&self, index: usize) -> Range<usize> {
        self.starts[index]..self.starts[index + 1]
    }

    /// The ids of all pedestrians, ascending, each once.
    pub fn pedestrians(&self) -> Vec<PedestrianId> {
        self.tracks().into_keys().collect()
    }

    /// One pedestrian's observations in order of time; empty if no pedestrian has this id.
    pub fn track(&self, pedestrian: PedestrianId) -> Vec<Observation> {
        self.observations.iter().filter(|o| o.pedestrian == pedestrian).copied().collect()
    }
}
