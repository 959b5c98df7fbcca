//! Frames of observed places, and the answers to them.

use crate::error::DdlError;
use crate::forecast::answer::Answer;
use crate::forecast::request::Request;
use crate::live::memory_files::SessionMemory;
use crate::live::waiting::{SceneBatch, SceneWindows, WaitingWindows};
use crate::live::watched_scene::WatchedScene;
use crate::model::ddl::Ddl;
use crate::note::Note;
use ddl_core::{AdaptiveRegions, FRAME_LIMIT, PedestrianId, PedestrianNames, Position, Window};
use ddl_data::{LiveError, LiveTracks, SceneName};
use ddl_memory::PlaceMemory;
use std::borrow::Borrow;
use std::collections::BTreeMap;
use std::time::{Duration, Instant};

/// Time without a frame after which a scene is forgotten.
const IDLE_TIMEOUT: Duration = Duration::from_mins(10);
/// Ticks of a second, where frames have times.
const MICROSECONDS: f64 = 1e6;

/// One place, or many, observed frame by frame: tracks, memories, regions, and what is asked of each frame.
///
/// A forecast has the bits of [`Ddl::forecast`] on the window that
/// [`Recording::observed_windows`](ddl_data::Recording::observed_windows) cuts from all frames so far. With a memory,
/// this window also holds the recalled tracks. Adaptive regions, with their weights, are the only other difference. For
/// gaps, see [`LiveTracks`]. The model is owned, borrowed or shared: one model serves several sessions.
///
/// # One place
/// [`push`](Self::push) adds a frame and answers it. After an error nothing has changed: the frame may be pushed again
/// without the fault. A frame that is never pushed is a gap.
///
/// # Many scenes, of one camera each
/// A frame is [observed](Self::observe) at once: scenes do not wait for each other. If a pedestrian can be forecast at
/// this frame, its window joins a queue. The oldest windows of the queue, from any scenes, form a
/// [batch](Self::next_batch), which is [answered](Self::answer) in one call. No answer depends on the batch or on other
/// scenes. At most 10,000 windows wait; then frames are refused until some are taken. With
/// [`latest_only`](Self::latest_only) at most one window of each scene waits: that of a later frame replaces it, and
/// the replaced ones are [counted](WaitingWindows::dropped). Tracks and memory still use every frame.
///
/// # What is kept
/// The last 8 time steps of the pedestrians that are present, so the memory use is bounded by their number; with
/// adaptive regions the forecasts of the last 4.8 s; on request the [memory](Self::remembering) of the place, which
/// has a fixed capacity. There are at most 2,000 scenes; one without a frame for 10 minutes is forgotten when another
/// begins. No state of the networks is kept: their tokens are relative to goals and to the scene, which change at every
/// frame.
///
/// # Examples
/// ```
/// use ddl::data::{LiveTracks, PedestrianId};
/// use ddl::{BuiltinModel, Ddl, DeviceChoice, Request, Session};
///
/// let model = Ddl::builtin(BuiltinModel::default(), DeviceChoice::Cpu)?;
/// let mut session = Session::new(model, LiveTracks::new(), Request::default())?;
/// for frame in 0..7 {
///     let now = session.push(frame, [(PedestrianId(1), [0.5 * frame as f64, 0.0])])?;
///     assert!(now.answer.is_none());
/// }
/// let now = session.push(7, [(PedestrianId(1), [3.5, 0.0]), (PedestrianId(2), [9.0, 0.0])])?;
/// let (window, answer) = now.answer.expect("pedestrian 1 has 8 frames");
/// assert_eq!((window.frames()[7], window.pedestrians()), (7, &[PedestrianId(1)][..]));
/// assert!(answer.forecast().hypothesis(0, 0)[11][0] > 3.5, "it goes on");
/// # Ok::<(), ddl::DdlError>(())
/// ```
#[derive(Debug)]
pub struct Session<M> {
    model: M,
    request: Request,
    /// What each scene begins with.
    unseen: LiveTracks,
    scenes: BTreeMap<Option<SceneName>, WatchedScene>,
    waiting: WaitingWindows,
    regions: BTreeMap<Option<SceneName>, AdaptiveRegions>,
    memory: SessionMemory,
    /// Of scenes that have ended, until a frame is observed.
    notes: Vec<Note>,
    idle_timeout: Duration,
}

/// What a frame brought.
#[derive(Debug)]
#[non_exhaustive]
pub struct FrameAnswer {
    /// The answer, and the window that it is of: the pedestrians with their last 8 positions. `None` if no pedestrian
    /// can be forecast, or none is due.
    pub answer: Option<(Window, Answer)>,
    /// Whether a forecast was due, by the interval of the tracks.
    pub is_due: bool,
    /// What was doubted or left out.
    pub notes: Vec<Note>,
}

impl<M: Borrow<Ddl>> Session<M> {
    /// Largest number of scenes. It is twice that of a [`FrameReader`](ddl_data::FrameReader), so that there is room
    /// for new scenes beside those that the reader has just forgotten.
    const MOST_SCENES: usize = 2_000;
    /// Largest number of pedestrians of all scenes, those of the next frame counted twice.
    const MOST_PEDESTRIANS: usize = 400_000;

    /// A session without frames. Each scene begins with these tracks, which are empty; they have the clock, and say who
    /// is in a window and how often there is one.
    ///
    /// # Errors
    /// The request is one that the model has no answer to.
    pub fn new(model: M, tracks: LiveTracks, request: Request) -> Result<Self, DdlError> {
        model.borrow().check(&request)?;
        Ok(Self {
            model,
            request,
            unseen: tracks,
            scenes: BTreeMap::new(),
            waiting: WaitingWindows::default(),
            regions: BTreeMap::new(),
            memory: SessionMemory::None,
            notes: Vec::new(),
            idle_timeout: IDLE_TIMEOUT,
        })
    }

    /// Remembers the paths of earlier pedestrians, which then influence the forecasts. A forecast uses observations
    /// before its frame. A memory of at least 500 segments is tested on the first pedestrians. If it is of another
    /// place, it is [refused](PlaceMemory::refused), and an empty one replaces it.
    ///
    /// # Errors
    /// When the model has no memory branch, or the memory of a file another number of frames per step.
    ///
    /// # Panics
    /// After the first frame.
    pub fn remembering(mut self, memory: SessionMemory) -> Result<Self, DdlError> {
        assert!(self.scenes.is_empty(), "a session begins to remember before its first frame");
        self.memory = memory;
        if self.memory.is_of_one_place() {
            // Its faults show before the first frame.
            let scene = self.begin_scene(None)?;
            self.scenes.insert(None, scene);
        } else if !matches!(self.memory, SessionMemory::None) {
            self.model.borrow().goal_model().recalled_per_pedestrian()?;
        }
        Ok(self)
    }

    /// Keeps only the latest window of each scene in the queue.
    #[must_use]
    pub fn latest_only(mut self) -> Self {
        self.waiting.is_latest_only = true;
        self
    }

    /// Asks for something else from the next answer on.
    ///
    /// # Errors
    /// As [`new`](Self::new); the session then asks as before.
    pub fn ask(&mut self, request: Request) -> Result<(), DdlError> {
        self.model.borrow().check(&request)?;
        self.request = request;
        Ok(())
    }

    /// Adds a frame of the one place, with the positions (m) of all pedestrians in any order, and answers it.
    ///
    /// # Errors
    /// [`DdlError::Live`] for a frame out of order, a position that is not finite or a repeated pedestrian;
    /// [`DdlError::Forecast`] when the forecast fails, for instance because positions are too large. After an error
    /// nothing has changed.
    pub fn push(
        &mut self,
        frame: i64,
        pedestrians: impl IntoIterator<Item = (PedestrianId, Position)>,
    ) -> Result<FrameAnswer, DdlError> {
        self.push_named(frame, pedestrians, &PedestrianNames::default())
    }

    /// As [`push`](Self::push), with the names of those pedestrians who have some.
    ///
    /// # Errors
    /// As [`push`](Self::push).
    pub fn push_named(
        &mut self,
        frame: i64,
        pedestrians: impl IntoIterator<Item = (PedestrianId, Position)>,
        names: &PedestrianNames,
    ) -> Result<FrameAnswer, DdlError> {
        let pedestrians: Vec<_> = pedestrians.into_iter().collect();
        self.ensure_room(pedestrians.len())?;
        if !self.scenes.contains_key(&None) {
            let scene = self.begin_scene(None)?;
            self.scenes.insert(None, scene);
        }
        let Some(scene) = self.scenes.get_mut(&None) else { unreachable!("it was just begun") };
        let (model, request) = (self.model.borrow(), &self.request);
        let answered = scene.push(frame, pedestrians, names, |window| {
            model.forecast_plainly(std::slice::from_ref(window), request).map(|mut answers| answers.remove(0))
        })?;
        let (is_due, mut notes) = (scene.tracks.is_moment(), scene.notes(None));
        let answer = answered.map(|(window, answer)| {
            notes.extend(Note::of_given(self.request.plan(), &window, &answer));
            let answer = self.adapted(None, &window, answer);
            (window, answer)
        });
        Ok(FrameAnswer { answer, is_due, notes })
    }

    /// As [`push`](Self::push), for a time in seconds or a frame number, as the clock of the tracks counts.
    ///
    /// # Errors
    /// As [`push`](Self::push), inside [`DdlError::At`]; [`DdlError::Moment`] for a number that is not finite, has a
    /// fraction where frames are numbered, or is too large to be exact.
    pub fn push_at(
        &mut self,
        at: f64,
        pedestrians: impl IntoIterator<Item = (PedestrianId, Position)>,
    ) -> Result<FrameAnswer, DdlError> {
        let is_time = self.unseen.clock().counts_times();
        let frame = if is_time { (MICROSECONDS * at).round() } else { at };
        // False for NaN.
        if !(frame.fract() == 0.0 && frame.abs() < FRAME_LIMIT as f64) {
            return Err(DdlError::Moment { at });
        }
        self.push(frame as i64, pedestrians).map_err(|error| DdlError::At { at, is_time, error: error.into() })
    }

    /// Adds a frame of a scene, with the positions (m) of all pedestrians in any order, and the names of those who have
    /// some. `None` is the scene of a stream without scene names; it is never forgotten. The window of the frame, if
    /// there is one, waits for its answer.
    ///
    /// # Errors
    /// [`DdlError::Live`] for a frame that is out of order within its scene, a position that is not finite or a
    /// repeated pedestrian, or too many of them; [`DdlError::TooManyScenes`] and [`DdlError::TooManyWaiting`] beyond
    /// the limits. After an error the tracks are as they were; scenes that were idle have ended.
    pub fn observe(
        &mut self,
        scene: Option<&SceneName>,
        frame: i64,
        pedestrians: impl IntoIterator<Item = (PedestrianId, Position)>,
        names: &PedestrianNames,
    ) -> Result<Vec<Note>, DdlError> {
        let pedestrians: Vec<_> = pedestrians.into_iter().collect();
        self.waiting.ensure_room()?;
        self.ensure_room(pedestrians.len())?;
        let (name, mut begun) = (scene.cloned(), None);
        if !self.scenes.contains_key(&name) {
            self.end_idle();
            begun = Some(self.begin_beside_others(scene)?);
        }
        let Some(watched) = begun.as_mut().or(self.scenes.get_mut(&name)) else { unreachable!("known or begun") };
        let window = watched.push(frame, pedestrians, names, |_| Ok(()))?.map(|(window, ())| window);
        watched.heard = scene.map(|_| Instant::now());
        let is_due = watched.tracks.is_moment();
        self.notes.extend(watched.notes(scene));
        if let Some(begun) = begun {
            self.scenes.insert(name.clone(), begun);
        }
        self.waiting.add(name, window, is_due);
        Ok(std::mem::take(&mut self.notes))
    }

    /// Says that a scene begins again, as when a reader of many scenes had forgotten it: its tracks end, and scenes
    /// without a frame for long are forgotten, after their memories are written.
    pub fn begin_again(&mut self, scene: Option<&SceneName>) -> Vec<Note> {
        self.end_idle();
        if scene.is_some() {
            self.clear(scene);
        }
        std::mem::take(&mut self.notes)
    }

    /// Forgets the tracks of a scene, as when its tracker restarts: any frame may follow. The memory of the place and
    /// the adapted regions are kept.
    pub fn clear(&mut self, scene: Option<&SceneName>) {
        if let Some(scene) = self.scenes.get_mut(&scene.cloned()) {
            scene.clear();
        }
        if let Some(regions) = self.regions.get_mut(&scene.cloned()) {
            regions.clear();
        }
    }

    /// Removes the oldest windows from the queue: as many as have together at most `pedestrians` pedestrians, and at
    /// least one.
    pub fn next_batch(&mut self, pedestrians: usize) -> SceneBatch {
        self.waiting.take(pedestrians)
    }

    /// The answers to windows in order of time, such as those of a [batch](Self::next_batch). Windows of a file, which
    /// this session has not observed, are answered like those of a stream.
    ///
    /// # Errors
    /// As [`Ddl::forecast`]; the windows are then not answered.
    pub fn answer(&mut self, windows: SceneWindows<'_>) -> Result<Vec<Answer>, DdlError> {
        let answers = self.model.borrow().forecast_plainly(windows.windows, &self.request)?;
        Ok(self.adapt(windows, answers))
    }

    /// The answers of the model itself to windows, with regions and weights that follow their places if the session
    /// asks for that: [`answer`](Self::answer) in two steps, between which others may use the session.
    pub fn adapt(&mut self, windows: SceneWindows<'_>, answers: Vec<Answer>) -> Vec<Answer> {
        let answered = windows.windows.iter().zip(answers).enumerate();
        answered.map(|(i, (window, answer))| self.adapted(windows.scene(i), window, answer)).collect()
    }

    /// Writes the memories for which a minute has passed. A full disk costs no forecast.
    pub fn write_due(&mut self) -> Vec<Note> {
        self.scenes.values_mut().filter_map(WatchedScene::write_due).collect()
    }

    fn adapted(&mut self, scene: Option<&SceneName>, window: &Window, answer: Answer) -> Answer {
        // A scene that has ended since learns no more.
        if !self.request.adaptive_regions || (scene.is_some() && self.tracks(scene).is_none()) {
            return answer;
        }
        answer.adapted(self.regions.entry(scene.cloned()).or_default(), window)
    }

    /// Where the session keeps what its places teach.
    pub fn memory(&self) -> &SessionMemory {
        &self.memory
    }

    /// The tracks of a scene.
    pub fn tracks(&self, scene: Option<&SceneName>) -> Option<&LiveTracks> {
        Some(&self.scenes.get(&scene.cloned())?.tracks)
    }

    /// The place of a scene, if it is [remembered](Self::remembering).
    pub fn place(&self, scene: Option<&SceneName>) -> Option<&PlaceMemory> {
        self.scenes.get(&scene.cloned())?.place.as_ref()
    }

    /// The windows that wait for an answer.
    pub fn waiting(&self) -> &WaitingWindows {
        &self.waiting
    }

    /// Writes the memories of all scenes, and closes their files. A file that cannot be written stays open, so that it
    /// can be tried again.
    pub fn close(&mut self) -> Vec<Note> {
        self.scenes.values_mut().filter_map(WatchedScene::close).collect()
    }

    /// Forgets the scenes that have been without a frame for long, after their memories are written.
    fn end_idle(&mut self) {
        let is_idle = |_: &Option<SceneName>, scene: &mut WatchedScene| {
            scene.heard.is_some_and(|heard| heard.elapsed() >= self.idle_timeout)
        };
        for (name, mut scene) in self.scenes.extract_if(.., is_idle) {
            self.notes.extend(scene.close());
            self.regions.remove(&name);
            self.waiting.forget(name.as_ref());
        }
    }

    fn ensure_room(&self, pedestrians: usize) -> Result<(), DdlError> {
        let kept: usize = self.scenes.values().map(|scene| scene.tracks.len()).sum();
        if kept + pedestrians > Self::MOST_PEDESTRIANS {
            return Err(LiveError::TooManyPedestrians { limit: Self::MOST_PEDESTRIANS }.into());
        }
        Ok(())
    }

    /// A named scene whose memory cannot be used begins without memory.
    fn begin_beside_others(&mut self, scene: Option<&SceneName>) -> Result<WatchedScene, DdlError> {
        if self.scenes.len() >= Self::MOST_SCENES {
            let minutes = self.idle_timeout.as_secs() / 60;
            return Err(DdlError::TooManyScenes { limit: Self::MOST_SCENES, minutes });
        }
        match (self.begin_scene(scene), scene) {
            (Err(error), Some(_)) => {
                self.notes.push(Note::MemoryFailed(error.into()));
                Ok(WatchedScene::new(self.unseen.clone()))
            }
            (begun, _) => begun,
        }
    }

    fn begin_scene(&mut self, name: Option<&SceneName>) -> Result<WatchedScene, DdlError> {
        let scene = WatchedScene::new(self.unseen.clone());
        match self.memory.of_scene(name)? {
            Some(memory) => scene.remembering(self.model.borrow(), memory),
            None => Ok(scene),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::live::watched_scene::tests::model;

    fn name(scene: &str) -> SceneName {
        SceneName::new(scene).unwrap()
    }

    fn session(model: &Ddl) -> Session<&Ddl> {
        Session::new(model, LiveTracks::new(), Request::default()).unwrap()
    }

    fn observed<M: Borrow<Ddl>>(
        session: &mut Session<M>,
        scene: &str,
        frame: i64,
        seen: &[(PedestrianId, Position)],
    ) -> Result<Vec<Note>, DdlError> {
        let scene = (!scene.is_empty()).then(|| name(scene));
        let names = PedestrianNames::default();
        session.observe(scene.as_ref(), frame, seen.iter().copied(), &names)
    }

    #[test]
    fn what_is_kept_is_bounded() {
        let model = model();
        let mut many = session(&model);
        for scene in 0..Session::<&Ddl>::MOST_SCENES {
            observed(&mut many, &scene.to_string(), 0, &[]).unwrap();
        }
        let error = observed(&mut many, "more", 0, &[]).unwrap_err().to_string();
        assert!(error.contains("more than 2000") && error.contains("10 minutes"), "{error}");
        // Scenes without a frame are forgotten at once.
        many.idle_timeout = Duration::ZERO;
        observed(&mut many, "more", 0, &[]).unwrap();
        assert_eq!(many.scenes.keys().cloned().collect::<Vec<_>>(), [Some(name("more"))]);
        let mut many = session(&model);
        let seen = [(PedestrianId(1), [0.0, 0.0])];
        let waiting = WaitingWindows::MOST as i64;
        for frame in 0..waiting + 7 {
            observed(&mut many, "", frame, &seen).unwrap();
        }
        let error = observed(&mut many, "", waiting + 7, &seen).unwrap_err().to_string();
        assert!(error.contains("10000 frames wait"), "{error}");
        many.next_batch(1);
        observed(&mut many, "", waiting + 7, &seen).unwrap();
        let mut many = session(&model);
        let crowd: Vec<_> = (0..100_000).map(|id| (PedestrianId(id), [id as f64, 0.0])).collect();
        for scene in ["0", "1", "2", "3"] {
            observed(&mut many, scene, 0, &crowd).unwrap();
        }
        let error = observed(&mut many, "4", 0, &crowd).unwrap_err().to_string();
        assert!(error.contains("more than 400000 pedestrians"), "{error}");
    }
}
