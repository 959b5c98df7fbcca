//! Many cameras in one process, whose frames are forecast together.

use crate::error::DdlError;
use crate::forecast::watch::Watch;
use crate::forecast::watched_place::WatchedPlace;
use ddl_data::{Completion, Frame, LiveTracks, PedestrianId, PedestrianNames, Position, SceneName, Window};
use ddl_eval::{Forecast, ForecastError, Forecaster};
use std::collections::{BTreeMap, VecDeque};
use std::time::{Duration, Instant};

/// The tracks of many scenes, a camera each, and the windows that wait to be forecast from.
///
/// A frame is [observed](Self::observe) at once, whatever is being forecast: scenes do not wait for each other. Where
/// somebody can be forecast from it, its window waits. Waiting windows of any scenes make a [batch](Self::next_batch),
/// the oldest first, which one call of a model forecasts. Whether a window is forecast alone or in a batch, and what
/// other scenes do in between, changes no bit of its forecast: it is that of a
/// [`LiveForecaster`](crate::LiveForecaster) of this scene alone.
///
/// # Overload
/// Every window waits, up to [`MOST_WAITING`](Self::MOST_WAITING); then frames are refused until some are forecast.
/// With [`latest_only`](Self::latest_only) one window of each scene waits at most: a later frame takes its place in the
/// queue, which is [counted](Self::dropped). Tracks and memory take every frame all the same.
///
/// # What is kept
/// What a `LiveForecaster` keeps, of each scene; at most [`MOST_SCENES`](Self::MOST_SCENES) of them. A scene of which
/// no frame has come for [`SILENCE`](Self::SILENCE) is forgotten when another one begins, or by
/// [`forget_silent`](Self::forget_silent). Regions that adapt are the caller's: one
/// [`AdaptiveRegions`](ddl_eval::AdaptiveRegions) a scene.
///
/// # Examples
/// ```
/// use ddl::LiveScenes;
/// use ddl::data::{PedestrianId, SceneName};
/// use ddl::eval::baseline::ConstantVelocity;
///
/// let [hall, yard] = ["hall", "yard"].map(|name| SceneName::new(name).expect("a short name"));
/// let mut scenes = LiveScenes::new();
/// for frame in 0..8 {
///     let x = 0.5 * frame as f64;
///     scenes.observe(Some(&hall), frame, [(PedestrianId(1), [x, 0.0])])?;
///     scenes.observe(Some(&yard), 100 + frame, [(PedestrianId(1), [0.0, x])])?;
/// }
/// let answers = scenes.forecast(&ConstantVelocity::last_step(), 100);
/// assert_eq!(answers.len(), 2);
/// assert_eq!(answers[1].scene.as_ref(), Some(&yard));
/// assert_eq!(answers[1].forecast.as_ref().expect("a forecast").hypothesis(0, 0)[11], [0.0, 9.5]);
/// # Ok::<(), ddl::DdlError>(())
/// ```
#[derive(Debug, Clone)]
pub struct LiveScenes {
    unseen: LiveTracks,
    scenes: BTreeMap<Option<SceneName>, Scene>,
    waiting: VecDeque<(Option<SceneName>, Window)>,
    is_latest_only: bool,
    dropped: u64,
    silence: Duration,
}

#[derive(Debug, Clone)]
struct Scene {
    watch: Watch,
    heard: Instant,
    dropped: u64,
}

/// Windows of some scenes, to be forecast together.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct SceneBatch {
    /// The scene of each window; `None` for that of a stream that names none.
    pub scenes: Vec<Option<SceneName>>,
    /// As many windows.
    pub windows: Vec<Window>,
}

/// What is forecast from a frame of a scene.
#[derive(Debug)]
#[non_exhaustive]
pub struct SceneForecast {
    /// The scene; `None` for that of a stream that names none.
    pub scene: Option<SceneName>,
    /// Who is forecast, in the order of the forecast, and their last 8 positions.
    pub window: Window,
    /// The forecast, or why there is none. An error of one scene leaves the others as they are.
    pub forecast: Result<Forecast, ForecastError>,
}

impl LiveScenes {
    /// Scenes at a time: twice as many as a [`FrameReader`](ddl_data::FrameReader) reads, so that those which it has
    /// just forgotten have room beside the new ones.
    pub const MOST_SCENES: usize = 2_000;
    /// Windows that wait at most.
    pub const MOST_WAITING: usize = 10_000;
    /// Pedestrians of a batch that answers soon: several cameras of a dozen, and never more than one crowd.
    pub const BATCH: usize = 50;
    /// Time without a frame after which a scene is forgotten.
    pub const SILENCE: Duration = Duration::from_mins(10);

    /// No scene seen yet; frames are counted, so that one step of 0.4 s is from one number to the next.
    #[must_use]
    pub fn new() -> Self {
        Self::of(LiveTracks::new())
    }

    /// No scene seen yet, with another number of raw frames in a step of 0.4 s, such as 10 of cameras at 25 frames a
    /// second.
    ///
    /// # Errors
    /// [`DdlError::Live`] if the step does not lie in 1..=2^31.
    pub fn with_frame_step(frame_step: i64) -> Result<Self, DdlError> {
        Ok(Self::of(LiveTracks::with_frame_step(frame_step)?))
    }

    fn of(unseen: LiveTracks) -> Self {
        Self {
            unseen,
            scenes: BTreeMap::new(),
            waiting: VecDeque::new(),
            is_latest_only: false,
            dropped: 0,
            silence: Self::SILENCE,
        }
    }

    /// The same, with incomplete observations filled in as the completion allows.
    #[must_use]
    pub fn with_completion(self, completion: Completion) -> Self {
        Self {
            unseen: self.unseen.with_completion(completion),
            ..self
        }
    }

    /// The same, where of each scene only the latest frame waits to be forecast from.
    #[must_use]
    pub fn latest_only(self) -> Self {
        Self {
            is_latest_only: true,
            ..self
        }
    }

    /// The same, with another time after which a scene of which no frame comes is forgotten.
    #[must_use]
    pub fn forgetting_after(self, silence: Duration) -> Self {
        Self { silence, ..self }
    }

    /// Raw frames in one step of 0.4 s.
    pub fn frame_step(&self) -> i64 {
        self.unseen.frame_step()
    }

    /// Adds a frame of a scene, everybody's positions (m) in any order. `None` is the scene of a stream that names
    /// none, and is never forgotten for its silence.
    ///
    /// # Errors
    /// [`DdlError::Live`] for a frame that is out of order within its scene, a position that is not finite or somebody
    /// twice; [`DdlError::TooManyScenes`] and [`DdlError::TooManyWaiting`] beyond the limits. Nothing has changed then.
    pub fn observe(
        &mut self,
        scene: Option<&SceneName>,
        frame: i64,
        people: impl IntoIterator<Item = (PedestrianId, Position)>,
    ) -> Result<(), DdlError> {
        let people = people.into_iter().collect();
        self.add(scene.cloned(), frame, people, PedestrianNames::default())
    }

    /// The same with a frame as it was read, whose pedestrians keep their words. Of a scene that [begins
    /// anew](Frame::is_first) the tracks are forgotten first; what is remembered of its place stays.
    ///
    /// # Errors
    /// As [`observe`](Self::observe).
    pub fn observe_frame(&mut self, frame: Frame) -> Result<(), DdlError> {
        if frame.is_first
            && frame.scene.is_some()
            && let Some(scene) = self.scenes.get_mut(&frame.scene)
        {
            scene.watch.clear();
        }
        self.add(frame.scene, frame.number, frame.people, frame.names)
    }

    fn add(
        &mut self,
        name: Option<SceneName>,
        frame: i64,
        people: Vec<(PedestrianId, Position)>,
        names: PedestrianNames,
    ) -> Result<(), DdlError> {
        if self.waiting.len() >= Self::MOST_WAITING {
            return Err(DdlError::TooManyWaiting {
                limit: Self::MOST_WAITING,
            });
        }
        let scene = self.scene(&name)?;
        let made = scene.watch.push(frame, people, |_| Ok::<_, DdlError>(()))?;
        scene.heard = Instant::now();
        let window = made.map(|(window, ())| window.with_names(names));
        let mut waiting = self.waiting.iter();
        let older = waiting.position(|(of, _)| self.is_latest_only && *of == name);
        match (older, window) {
            (Some(at), window) => {
                self.dropped += 1;
                if let Some(scene) = self.scenes.get_mut(&name) {
                    scene.dropped += 1;
                }
                match window {
                    Some(window) => self.waiting[at].1 = window,
                    None => drop(self.waiting.remove(at)),
                }
            }
            (None, Some(window)) => self.waiting.push_back((name, window)),
            (None, None) => {}
        }
        Ok(())
    }

    /// The scene, which begins if it is not known.
    #[expect(clippy::ref_option, reason = "a key of the map")]
    fn scene(&mut self, name: &Option<SceneName>) -> Result<&mut Scene, DdlError> {
        if !self.scenes.contains_key(name) {
            self.forget_silent();
            if self.scenes.len() >= Self::MOST_SCENES {
                return Err(DdlError::TooManyScenes {
                    limit: Self::MOST_SCENES,
                    minutes: self.silence.as_secs() / 60,
                });
            }
        }
        let unseen = || Scene {
            watch: Watch::new(self.unseen.clone()),
            heard: Instant::now(),
            dropped: 0,
        };
        Ok(self.scenes.entry(name.clone()).or_insert_with(unseen))
    }

    /// Lets a scene look at what is remembered of its place, and go on remembering.
    ///
    /// # Errors
    /// When the memory has another number of raw frames in a step; [`DdlError::TooManyScenes`] beyond that limit.
    pub fn remember(&mut self, scene: Option<&SceneName>, place: WatchedPlace) -> Result<(), DdlError> {
        self.scene(&scene.cloned())?.watch.remember(place)
    }

    /// The place of a scene that [remembers](Self::remember).
    pub fn place(&self, scene: Option<&SceneName>) -> Option<&WatchedPlace> {
        self.scenes.get(&scene.cloned())?.watch.place.as_ref()
    }

    /// Decides whether the memory of a scene is of its place ([`WatchedPlace::finish_test`]).
    pub fn finish_test(&mut self, scene: Option<&SceneName>) {
        let scene = self.scenes.get_mut(&scene.cloned());
        if let Some(place) = scene.and_then(|scene| scene.watch.place.as_mut()) {
            place.finish_test();
        }
    }

    /// Forgets a scene; what it remembered of its place is given back. Its windows that wait stay.
    pub fn forget(&mut self, scene: Option<&SceneName>) -> Option<WatchedPlace> {
        self.scenes.remove(&scene.cloned())?.watch.place
    }

    /// Scenes of which no frame has come for so long that they are forgotten when another one begins.
    pub fn silent(&self) -> Vec<SceneName> {
        let scenes = self.scenes.iter();
        let silent = scenes.filter(|(_, scene)| scene.heard.elapsed() >= self.silence);
        silent.filter_map(|(name, _)| name.clone()).collect()
    }

    /// Forgets the [silent](Self::silent) scenes, and what they remembered.
    pub fn forget_silent(&mut self) {
        for scene in self.silent() {
            self.forget(Some(&scene));
        }
    }

    /// Scenes that are known.
    pub fn len(&self) -> usize {
        self.scenes.len()
    }

    /// Whether no scene is known.
    pub fn is_empty(&self) -> bool {
        self.scenes.is_empty()
    }

    /// Windows that wait to be forecast from.
    pub fn waiting(&self) -> usize {
        self.waiting.len()
    }

    /// Windows that were never forecast from, because a later frame of their scene came first.
    pub fn dropped(&self) -> u64 {
        self.dropped
    }

    /// The scene, of those known, with the most [dropped](Self::dropped) windows, and how many.
    pub fn most_dropped(&self) -> Option<(&SceneName, u64)> {
        let scenes = self.scenes.iter();
        let named = scenes.filter_map(|(name, scene)| Some((name.as_ref()?, scene.dropped)));
        named
            .filter(|(_, dropped)| *dropped > 0)
            .max_by_key(|(_, dropped)| *dropped)
    }

    /// Takes the oldest windows out, as many as have so many pedestrians, and at least one.
    pub fn next_batch(&mut self, pedestrians: usize) -> SceneBatch {
        let mut batch = SceneBatch::default();
        let mut taken = 0;
        while let Some((_, window)) = self.waiting.front() {
            taken += window.len();
            if taken > pedestrians && !batch.windows.is_empty() {
                break;
            }
            if let Some((scene, window)) = self.waiting.pop_front() {
                batch.scenes.push(scene);
                batch.windows.push(window);
            }
        }
        batch
    }

    /// Forecasts the [next batch](Self::next_batch), in its order.
    pub fn forecast<M: Forecaster>(&mut self, model: &M, pedestrians: usize) -> Vec<SceneForecast> {
        let SceneBatch { scenes, windows } = self.next_batch(pedestrians);
        let forecasts: Vec<_> = match model.forecast_all(&windows) {
            Ok(forecasts) => forecasts.into_iter().map(Ok).collect(),
            // Of which window, it does not say.
            Err(_) => windows.iter().map(|window| model.forecast(window)).collect(),
        };
        let each = scenes.into_iter().zip(windows).zip(forecasts);
        each.map(|((scene, window), forecast)| SceneForecast {
            scene,
            window,
            forecast,
        })
        .collect()
    }
}

impl Default for LiveScenes {
    fn default() -> Self {
        Self::new()
    }
}
