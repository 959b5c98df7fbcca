//! A window: pedestrians over 8 observed and 12 future steps.

use std::sync::Arc;

use crate::error::WindowError;
use crate::pedestrian::{PedestrianId, PedestrianName, PedestrianNames};
use crate::position::{OBSERVED, Position, WINDOW, is_finite, is_frame, is_frame_step};
use crate::quality::{ObservationQuality, OtherObservation};

/// 20 positions of an earlier pedestrian of the same place that moved like the one to forecast.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RememberedTrack {
    /// `[x, y]` in metres, 0.4 s apart: 8 positions similar to the observed ones, and the 12 that followed.
    pub track: [Position; WINDOW],
    /// Dissimilarity of the first 8 positions to the observed ones: a squared distance of present position and
    /// velocities, at least 0.
    pub distance: f64,
}

/// The pedestrians of one scene over 8 observed steps and, where known, the 12 that follow.
///
/// # Shapes
/// N pedestrians, each with a track of T = 20 positions ([`WINDOW`]), or of T = 8 ([`OBSERVED`]) when the future is
/// unknown, `[x, y]` in metres, 0.4 s apart. Pedestrians and steps are counted from 0; an index out of range panics.
///
/// ```
/// use ddl_core::{PedestrianId, Window};
///
/// let straight: Vec<_> = (0..20).map(|t| [0.5 * f64::from(t), 0.0]).collect();
/// let window = Window::new("yard", 0, 10, vec![PedestrianId(1)], vec![straight])?;
/// assert_eq!(window.observed(0).len(), 8);
/// assert_eq!(window.end(0), Some([9.5, 0.0]));
/// assert!(window.without_future().end(0).is_none());
/// # Ok::<(), ddl_core::WindowError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Window {
    recording: Arc<str>,
    frame_step: i64,
    /// Raw frame of each step; `steps()` entries.
    frames: Vec<i64>,
    pedestrians: Vec<PedestrianId>,
    names: PedestrianNames,
    /// Pedestrian-major: pedestrian i has `positions[i * T..(i + 1) * T]`.
    positions: Vec<Position>,
    /// One entry per pedestrian, or empty if nothing was estimated.
    qualities: Vec<ObservationQuality>,
    /// Pedestrians with another explanation, by index.
    others: Vec<(usize, OtherObservation)>,
    /// One list per pedestrian, or empty if nothing is remembered.
    remembered: Vec<Vec<RememberedTrack>>,
    /// Pedestrians that were observed too, but have no future here.
    bystanders: Option<Box<Window>>,
}

#[expect(clippy::len_without_is_empty, reason = "a window holds at least one pedestrian")]
impl Window {
    /// Creates a window from tracks, one per pedestrian.
    ///
    /// `start_frame` is the raw frame of the first position, `frame_step` the number of raw frames per step.
    ///
    /// # Errors
    /// If there are no pedestrians, if the numbers of ids and tracks differ, or if an id is repeated. If the tracks are
    /// not all of 8 or all of 20 positions, if a position is not finite, or if frames are out of range.
    pub fn new(
        recording: impl Into<Arc<str>>,
        start_frame: i64,
        frame_step: i64,
        pedestrians: Vec<PedestrianId>,
        tracks: Vec<Vec<Position>>,
    ) -> Result<Self, WindowError> {
        if pedestrians.len() != tracks.len() {
            let (pedestrians, tracks) = (pedestrians.len(), tracks.len());
            return Err(WindowError::Count { pedestrians, tracks });
        }
        if !(is_frame_step(frame_step) && is_frame(start_frame)) {
            return Err(WindowError::Frames { start_frame, frame_step });
        }
        let steps = tracks.first().ok_or(WindowError::Empty)?.len();
        let mut sorted = pedestrians.clone();
        sorted.sort_unstable();
        if let Some(pair) = sorted.windows(2).find(|w| w[0] == w[1]) {
            return Err(WindowError::Duplicate { pedestrian: pair[0] });
        }
        for (&pedestrian, track) in pedestrians.iter().zip(&tracks) {
            let found = track.len();
            if found != steps || (steps != OBSERVED && steps != WINDOW) {
                return Err(WindowError::Length { pedestrian, found });
            }
            if let Some(index) = track.iter().position(|&place| !is_finite(place)) {
                let position = track[index];
                return Err(WindowError::NotFinite { pedestrian, index, position });
            }
        }
        let frames = (0..).map(|t| start_frame + t * frame_step).take(steps).collect();
        let positions = tracks.into_iter().flatten().collect();
        Ok(Self::cut(recording.into(), frame_step, frames, pedestrians, positions))
    }

    /// A window cut from rows that are checked already: the positions are finite, the frames ascend, and the
    /// pedestrians differ. The frames may be further apart than `frame_step`.
    ///
    /// # Shapes
    /// `frames` `[T]`, 8 or 20; `positions` `[N][T]`, metres.
    ///
    /// # Panics
    /// When the lengths of the arrays disagree.
    pub fn cut(
        recording: Arc<str>,
        frame_step: i64,
        frames: Vec<i64>,
        pedestrians: Vec<PedestrianId>,
        positions: Vec<Position>,
    ) -> Self {
        assert!([OBSERVED, WINDOW].contains(&frames.len()), "{} frames", frames.len());
        assert_eq!(positions.len(), pedestrians.len() * frames.len(), "positions");
        Self {
            recording,
            frame_step,
            frames,
            pedestrians,
            names: PedestrianNames::default(),
            positions,
            qualities: Vec::new(),
            others: Vec::new(),
            remembered: Vec::new(),
            bystanders: None,
        }
    }

    /// The same window with these names of its pedestrians.
    #[must_use]
    pub fn with_names(self, names: PedestrianNames) -> Self {
        Self { names, ..self }
    }

    /// The name of the i-th pedestrian in the file or stream: its number, or a word.
    pub fn name(&self, i: usize) -> PedestrianName {
        self.names.of(self.pedestrians[i])
    }

    /// Index of the pedestrian with this name; `None` if the window has no such pedestrian.
    pub fn named(&self, name: &PedestrianName) -> Option<usize> {
        let mut ids = self.pedestrians.iter();
        ids.position(|&id| self.names.names(id, name))
    }

    /// The same window with the quality of each observation, `[N]`, or empty where nothing was estimated.
    ///
    /// # Panics
    /// When there is another number of qualities than of pedestrians.
    #[must_use]
    pub fn with_qualities(mut self, qualities: Vec<ObservationQuality>) -> Self {
        assert!(qualities.is_empty() || qualities.len() == self.len(), "{} qualities", qualities.len());
        let measured = qualities.iter().all(|quality| *quality == ObservationQuality::default());
        self.qualities = if measured { Vec::new() } else { qualities };
        self
    }

    /// How well the i-th pedestrian was observed; nothing was estimated unless qualities are
    /// [given](Self::with_qualities). [Another explanation](Self::other) adds its deviation.
    ///
    /// # Panics
    /// If `i >= len()`.
    pub fn quality(&self, i: usize) -> ObservationQuality {
        let own = self.own_quality(i);
        self.other(i).map_or(own, |other| other.beside(self.observed(i), own))
    }

    /// How well the i-th pedestrian was observed by its likelier explanation alone.
    ///
    /// # Panics
    /// If `i >= len()`.
    pub fn own_quality(&self, i: usize) -> ObservationQuality {
        assert!(i < self.len(), "pedestrian {i} of {}", self.len());
        self.qualities.get(i).copied().unwrap_or_default()
    }

    /// The same window with other explanations of some pedestrians, by ascending index. The observed positions are
    /// those of the likelier explanation.
    ///
    /// # Panics
    /// When an index is out of range, or they do not ascend.
    #[must_use]
    pub fn with_others(self, others: Vec<(usize, OtherObservation)>) -> Self {
        assert!(
            others.is_sorted_by(|a, b| a.0 < b.0) && others.last().is_none_or(|last| last.0 < self.len()),
            "indices"
        );
        Self { others, ..self }
    }

    /// The other explanation of the rows of the i-th pedestrian, if it is [doubtful](Self::with_others).
    pub fn other(&self, i: usize) -> Option<&OtherObservation> {
        let place = self.others.binary_search_by_key(&i, |other| other.0).ok()?;
        Some(&self.others[place].1)
    }

    /// Whether some pedestrian has another explanation.
    pub fn has_others(&self) -> bool {
        !self.others.is_empty()
    }

    /// The window of the likelier explanations alone, and that of the others, in which those without one are the same.
    #[must_use]
    pub fn explanations(&self) -> [Window; 2] {
        let likelier = self.clone().with_others(Vec::new());
        let at = |i: usize, t: usize, position| self.other(i).map_or(position, |other| other.positions[t]);
        let other = likelier.map_positions(|i, t, position| if t < OBSERVED { at(i, t, position) } else { position });
        let quality = |i: usize| self.other(i).map_or_else(|| self.own_quality(i), |other| other.quality);
        let qualities = (0..self.len()).map(quality).collect();
        [likelier, other.with_qualities(qualities)]
    }

    /// The same window with bystanders: other pedestrians of the same 8 steps, whose futures are not known. A
    /// forecaster [receives](Self::without_future) them too, but they are not scored. The ids of the window must
    /// ascend.
    ///
    /// # Panics
    /// When the bystanders have other observed frames.
    #[must_use]
    pub fn with_bystanders(self, bystanders: Option<Window>) -> Self {
        let bystanders = bystanders.map(|window| Box::new(window.without_future()));
        if let Some(window) = &bystanders {
            assert_eq!(window.frames, self.frames[..OBSERVED], "frames of bystanders");
            assert!(self.pedestrians.is_sorted(), "ids of {:?}", self.pedestrians);
        }
        Self { bystanders, ..self }
    }

    /// Its [bystanders](Self::with_bystanders), if there are any.
    pub fn bystanders(&self) -> Option<&Window> {
        self.bystanders.as_deref()
    }

    /// The same window with remembered tracks of similar earlier pedestrians of the place, given by pedestrian index.
    ///
    /// All of them must have been observed by the last observed frame of the window, or in another recording of the
    /// place.
    #[must_use]
    pub fn with_remembered(self, remembered: impl FnMut(usize) -> Vec<RememberedTrack>) -> Self {
        let mut remembered: Vec<_> = (0..self.len()).map(remembered).collect();
        if remembered.iter().all(Vec::is_empty) {
            remembered.clear();
        }
        Self { remembered, ..self }
    }

    /// Remembered tracks for the i-th pedestrian, most similar first; empty unless [given](Self::with_remembered).
    ///
    /// # Panics
    /// If `i >= len()`.
    pub fn remembered(&self, i: usize) -> &[RememberedTrack] {
        assert!(i < self.len(), "pedestrian {i} of {}", self.len());
        self.remembered.get(i).map_or(&[], Vec::as_slice)
    }

    /// Name of the recording that the window was cut from.
    pub fn recording(&self) -> &str {
        &self.recording
    }

    /// Raw frame of the first position.
    pub fn start_frame(&self) -> i64 {
        self.frames[0]
    }

    /// Raw frame of each of the T positions, ascending and `frame_step` apart. Windows that were
    /// [cut](Self::cut) from a recording may contain larger gaps.
    pub fn frames(&self) -> &[i64] {
        &self.frames
    }

    /// Raw frames per step.
    pub fn frame_step(&self) -> i64 {
        self.frame_step
    }

    /// The pedestrians of the window; every index i refers to the i-th of these.
    pub fn pedestrians(&self) -> &[PedestrianId] {
        &self.pedestrians
    }

    /// Number of pedestrians N (at least one).
    pub fn len(&self) -> usize {
        self.pedestrians.len()
    }

    /// Consecutive windows of at most so many pedestrians in all; a larger window is a part of its own.
    pub fn parts(windows: &[Self], most: usize) -> impl Iterator<Item = &[Self]> {
        let mut pedestrians = 0;
        windows.chunk_by(move |window, next| {
            pedestrians += window.len();
            let fits = pedestrians + next.len() <= most;
            if !fits {
                pedestrians = 0;
            }
            fits
        })
    }

    /// Number of positions of each track, T: 20, or 8 without a future.
    pub fn steps(&self) -> usize {
        self.frames.len()
    }

    /// The i-th pedestrian's positions (m), 20, or 8 without a future.
    pub fn track(&self, i: usize) -> &[Position] {
        &self.positions[i * self.steps()..(i + 1) * self.steps()]
    }

    /// The i-th pedestrian's 8 observed positions (m).
    pub fn observed(&self, i: usize) -> &[Position] {
        &self.track(i)[..OBSERVED]
    }

    /// The i-th pedestrian's 12 positions to forecast (m); empty without a future.
    pub fn future(&self, i: usize) -> &[Position] {
        &self.track(i)[OBSERVED..]
    }

    /// Whether the 12 positions to forecast are known.
    pub fn has_future(&self) -> bool {
        self.steps() == WINDOW
    }

    /// Endpoint of the i-th pedestrian (m), if the future is known.
    pub fn end(&self, i: usize) -> Option<Position> {
        self.future(i).last().copied()
    }

    /// Positions of all pedestrians at one step, counted from 0 (m).
    #[must_use]
    pub fn positions_at(&self, step: usize) -> Vec<Position> {
        (0..self.len()).map(|i| self.track(i)[step]).collect()
    }

    /// The observation alone, as known when a forecast is made: the pedestrians of the window, or these and its
    /// [bystanders](Self::with_bystanders) in the order of their ids.
    #[must_use]
    pub fn without_future(&self) -> Window {
        let scene = self.scene();
        let pedestrians = scene.iter().map(|(window, i)| window.pedestrians[*i]).collect();
        let observed = scene.iter().flat_map(|(window, i)| window.observed(*i)).copied().collect();
        let window = self.of_same(self.frames[..OBSERVED].to_vec(), pedestrians, observed);
        window
            .with_qualities(scene.iter().map(|(window, i)| window.own_quality(*i)).collect())
            .with_others(others_of(scene.iter().map(|(window, i)| window.other(*i))))
            .with_remembered(|i| scene[i].0.remembered(scene[i].1).to_vec())
    }

    /// The index of each pedestrian in [`without_future`](Self::without_future).
    #[must_use]
    pub fn indices_in_scene(&self) -> Vec<usize> {
        let scored = self.scene().into_iter().enumerate().filter(|(_, (window, _))| std::ptr::eq(*window, self));
        scored.map(|(index, _)| index).collect()
    }

    /// The pedestrians and bystanders: the window of each, and its index there.
    fn scene(&self) -> Vec<(&Window, usize)> {
        let windows = std::iter::once(self).chain(self.bystanders.as_deref());
        let mut scene: Vec<(&Window, usize)> =
            windows.flat_map(|window| (0..window.len()).map(move |i| (window, i))).collect();
        if self.bystanders.is_some() {
            scene.sort_by_key(|(window, i)| window.pedestrians[*i]);
        }
        scene
    }

    fn of_same(&self, frames: Vec<i64>, pedestrians: Vec<PedestrianId>, positions: Vec<Position>) -> Self {
        let recording = Arc::clone(&self.recording);
        Self::cut(recording, self.frame_step, frames, pedestrians, positions).with_names(self.names.clone())
    }

    /// The window restricted to some of its pedestrians; `None` if none remain.
    #[must_use]
    pub fn filter_pedestrians(&self, mut keep: impl FnMut(usize) -> bool) -> Option<Window> {
        let indices: Vec<usize> = (0..self.len()).filter(|&i| keep(i)).collect();
        if indices.is_empty() {
            return None;
        }
        let pedestrians = indices.iter().map(|&i| self.pedestrians[i]).collect();
        let positions = indices.iter().flat_map(|&i| self.track(i)).copied().collect();
        let window = self.of_same(self.frames.clone(), pedestrians, positions);
        let window = window.with_qualities(indices.iter().map(|&i| self.own_quality(i)).collect());
        let window = window.with_others(others_of(indices.iter().map(|&i| self.other(i))));
        let window = window.with_remembered(|i| self.remembered(indices[i]).to_vec());
        let bystanders = self.bystanders.clone();
        Some(Self { bystanders, ..window })
    }

    /// The window with every position replaced by `f(i, step, position)`: pedestrian index, step from 0, position (m).
    /// The results of `f` are not checked; they must be finite. It also replaces the positions of other explanations.
    /// Remembered tracks and bystanders are unchanged.
    #[must_use]
    pub fn map_positions(&self, mut f: impl FnMut(usize, usize, Position) -> Position) -> Window {
        let mut mapped = self.clone();
        for (i, other) in &mut mapped.others {
            other.positions = std::array::from_fn(|step| f(*i, step, other.positions[step]));
        }
        let steps = self.steps();
        for (index, position) in mapped.positions.iter_mut().enumerate() {
            *position = f(index / steps, index % steps, *position);
        }
        mapped
    }

    /// The window in reversed time: every pedestrian walks its track from the end to the start, at the same frames.
    /// Remembered tracks, bystanders, qualities and other explanations are dropped, because they belong to the end.
    #[must_use]
    pub fn reversed(&self) -> Window {
        let alone = self.clone().with_remembered(|_| Vec::new()).with_bystanders(None);
        let mut reversed = alone.with_qualities(Vec::new()).with_others(Vec::new());
        for track in reversed.positions.chunks_exact_mut(self.steps()) {
            track.reverse();
        }
        reversed
    }
}

fn others_of<'a>(others: impl Iterator<Item = Option<&'a OtherObservation>>) -> Vec<(usize, OtherObservation)> {
    others.enumerate().filter_map(|(i, other)| Some((i, *other?))).collect()
}
