//! Many cameras in one process; their windows are forecast in batches.

use crate::error::DdlError;
use crate::live::place_memory::PlaceMemory;
use crate::live::watch::Watch;
use crate::model::ddl::Ddl;
use ddl_core::{PedestrianId, PedestrianNames, Position, Window};
use ddl_data::{Frame, LiveError, LiveTracks, SceneName};
use ddl_memory::SceneMemory;
use std::collections::{BTreeMap, VecDeque};
use std::time::{Duration, Instant};

/// The tracks of many scenes (one camera each), and the windows that wait for a forecast.
///
/// A frame is [observed](Self::observe) at once: scenes do not wait for each other. If a pedestrian can be forecast at
/// this frame, its window joins a queue. The oldest windows of the queue, from any scenes, form a
/// [batch](Self::next_batch), which the model forecasts in one call. The forecast of a window has the bits of that by a
/// [`LiveForecaster`](crate::LiveForecaster) for this scene alone: it does not depend on the batch or on other scenes.
///
/// # Overload
/// At most 10,000 windows wait; then frames are refused until some windows are forecast.
/// With [`latest_only`](Self::latest_only) at most one window of each scene waits: the window of a later frame replaces
/// it in the queue, and the replaced windows are [counted](Self::dropped). Tracks and memory still use every frame.
///
/// # What is kept
/// It keeps the state of a `LiveForecaster` for each scene, for at most 2,000 scenes. A
/// scene without a frame for 10 minutes is forgotten when another scene begins. For adaptive regions the caller keeps
/// one [`AdaptiveRegions`](ddl_core::AdaptiveRegions) per scene.
///
/// # Examples
/// ```
/// use ddl::data::{LiveTracks, PedestrianId, SceneName};
/// use ddl::{BuiltinModel, Ddl, DeviceChoice, Forecaster as _, LiveScenes};
///
/// let model = Ddl::builtin(BuiltinModel::default(), DeviceChoice::Cpu)?;
/// let [hall, yard] = ["hall", "yard"].map(|name| SceneName::new(name).expect("a short name"));
/// let mut scenes = LiveScenes::new(LiveTracks::new());
/// for frame in 0..8 {
///     let x = 0.5 * frame as f64;
///     scenes.observe(Some(&hall), frame, [(PedestrianId(1), [x, 0.0])])?;
///     scenes.observe(Some(&yard), 100 + frame, [(PedestrianId(1), [0.0, x])])?;
/// }
/// let batch = scenes.next_batch(100);
/// let forecasts = model.forecast_all(&batch.windows)?;
/// assert_eq!(batch.scenes[1].as_ref(), Some(&yard));
/// assert!(forecasts[1].hypothesis(0, 0)[11][1] > 3.5);
/// # Ok::<(), ddl::DdlError>(())
/// ```
#[derive(Debug, Clone)]
pub struct LiveScenes {
    unseen: LiveTracks,
    scenes: BTreeMap<Option<SceneName>, WatchedScene>,
    waiting: VecDeque<(Option<SceneName>, Window)>,
    is_latest_only: bool,
    dropped: u64,
    idle_timeout: Duration,
}

/// Time without a frame after which a scene is forgotten.
const IDLE_TIMEOUT: Duration = Duration::from_mins(10);

#[derive(Debug, Clone)]
struct WatchedScene {
    watch: Watch,
    heard: Instant,
    dropped: u64,
}

/// Windows of several scenes that are forecast in one call.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct SceneBatch {
    /// The scene of each window; `None` for a stream without scene names.
    pub scenes: Vec<Option<SceneName>>,
    /// The windows, in the order of `scenes`.
    pub windows: Vec<Window>,
}

impl LiveScenes {
    /// Largest number of scenes. It is twice that of a [`FrameReader`](ddl_data::FrameReader), so that there is room
    /// for new scenes beside those that the reader has just forgotten.
    pub(crate) const MOST_SCENES: usize = 2_000;
    /// Largest number of waiting windows.
    pub(crate) const MOST_WAITING: usize = 10_000;
    /// Largest number of pedestrians of all scenes, those of the next frame counted twice.
    pub(crate) const MOST_PEDESTRIANS: usize = 400_000;
    /// Number of pedestrians in a batch with a short latency: several cameras with a dozen pedestrians each, or one
    /// crowd.
    pub const BATCH: usize = 50;

    /// Starts without scenes; each begins with these tracks, which are empty.
    #[must_use]
    pub fn new(tracks: LiveTracks) -> Self {
        Self {
            unseen: tracks,
            scenes: BTreeMap::new(),
            waiting: VecDeque::new(),
            is_latest_only: false,
            dropped: 0,
            idle_timeout: IDLE_TIMEOUT,
        }
    }

    /// Keeps only the latest window of each scene in the queue.
    #[must_use]
    pub fn latest_only(self) -> Self {
        Self { is_latest_only: true, ..self }
    }

    /// Adds a frame of a scene, with the positions (m) of all pedestrians in any order. `None` is the scene of a stream
    /// without scene names; it is never forgotten.
    ///
    /// # Errors
    /// [`DdlError::Live`] for a frame that is out of order within its scene, a position that is not finite or a
    /// repeated pedestrian, or too many of them; [`DdlError::TooManyScenes`] and [`DdlError::TooManyWaiting`] beyond
    /// the limits. After an error nothing has changed.
    pub fn observe(
        &mut self,
        scene: Option<&SceneName>,
        frame: i64,
        pedestrians: impl IntoIterator<Item = (PedestrianId, Position)>,
    ) -> Result<(), DdlError> {
        let pedestrians = pedestrians.into_iter().collect();
        self.add(scene.cloned(), frame, pedestrians, &PedestrianNames::default())
    }

    /// Adds a frame as read by a [`FrameReader`](ddl_data::FrameReader); its pedestrians keep their names. If the scene
    /// [begins again](Frame::is_first), it is [cleared](Self::clear) first.
    ///
    /// # Errors
    /// As [`observe`](Self::observe); a scene that begins again stays cleared.
    pub fn observe_frame(&mut self, frame: Frame) -> Result<(), DdlError> {
        if frame.is_first && frame.scene.is_some() {
            self.clear(frame.scene.as_ref());
        }
        self.add(frame.scene, frame.number, frame.pedestrians, &frame.names)
    }

    /// Forgets the tracks of a scene, as when its tracker restarts; the memory of its place is kept.
    pub fn clear(&mut self, scene: Option<&SceneName>) {
        if let Some(scene) = self.scenes.get_mut(&scene.cloned()) {
            scene.watch.clear();
        }
    }

    fn add(
        &mut self,
        name: Option<SceneName>,
        frame: i64,
        pedestrians: Vec<(PedestrianId, Position)>,
        names: &PedestrianNames,
    ) -> Result<(), DdlError> {
        if self.waiting.len() >= Self::MOST_WAITING {
            return Err(DdlError::TooManyWaiting { limit: Self::MOST_WAITING });
        }
        let kept: usize = self.scenes.values().map(|scene| scene.watch.tracks.len()).sum();
        if kept + pedestrians.len() > Self::MOST_PEDESTRIANS {
            return Err(LiveError::TooManyPedestrians { limit: Self::MOST_PEDESTRIANS }.into());
        }
        let is_new = !self.scenes.contains_key(&name);
        let scene = self.scene(&name)?;
        scene.watch.tracks.name(names);
        let made = match scene.watch.push(frame, pedestrians, |_| Ok::<_, DdlError>(())) {
            Ok(made) => made,
            Err(error) => {
                if is_new {
                    self.scenes.remove(&name);
                }
                return Err(error);
            }
        };
        scene.heard = Instant::now();
        let is_moment = scene.watch.tracks.is_moment();
        let window = made.map(|(window, ())| window);
        let mut waiting = self.waiting.iter();
        let older = waiting.position(|(scene, _)| self.is_latest_only && *scene == name);
        match (older, window) {
            // A frame between two moments replaces nothing.
            (Some(_), None) if !is_moment => {}
            (Some(index), window) => {
                self.dropped += 1;
                if let Some(scene) = self.scenes.get_mut(&name) {
                    scene.dropped += 1;
                }
                match window {
                    Some(window) => self.waiting[index].1 = window,
                    None => drop(self.waiting.remove(index)),
                }
            }
            (None, Some(window)) => self.waiting.push_back((name, window)),
            (None, None) => {}
        }
        Ok(())
    }

    /// The scene; it is created if it is not known.
    #[expect(clippy::ref_option, reason = "a key of the map")]
    fn scene(&mut self, name: &Option<SceneName>) -> Result<&mut WatchedScene, DdlError> {
        if !self.scenes.contains_key(name) {
            self.forget_idle();
            if self.scenes.len() >= Self::MOST_SCENES {
                return Err(DdlError::TooManyScenes {
                    limit: Self::MOST_SCENES,
                    minutes: self.idle_timeout.as_secs() / 60,
                });
            }
        }
        let unseen = || WatchedScene { watch: Watch::new(self.unseen.clone()), heard: Instant::now(), dropped: 0 };
        Ok(self.scenes.entry(name.clone()).or_insert_with(unseen))
    }

    /// Gives a scene the memory of its place, or an empty one: forecasts read it, and it grows with every frame.
    ///
    /// # Errors
    /// As [`LiveForecaster::remembering`](crate::LiveForecaster::remembering); [`DdlError::TooManyScenes`] beyond that
    /// limit.
    pub fn remember(
        &mut self,
        scene: Option<&SceneName>,
        model: &Ddl,
        memory: Option<SceneMemory>,
    ) -> Result<(), DdlError> {
        self.scene(&scene.cloned())?.watch.remember(model, memory)
    }

    /// The tracks of a scene.
    pub fn tracks(&self, scene: Option<&SceneName>) -> Option<&LiveTracks> {
        Some(&self.scenes.get(&scene.cloned())?.watch.tracks)
    }

    /// The place of a scene, if it [has a memory](Self::remember).
    pub fn place(&self, scene: Option<&SceneName>) -> Option<&PlaceMemory> {
        self.scenes.get(&scene.cloned())?.watch.place.as_ref()
    }

    /// Forgets a scene, and returns its place with the memory. Its waiting windows stay in the queue.
    pub fn forget(&mut self, scene: Option<&SceneName>) -> Option<PlaceMemory> {
        self.scenes.remove(&scene.cloned())?.watch.place
    }

    /// Scenes that have been without a frame for so long that they are forgotten when another scene begins.
    pub fn idle(&self) -> Vec<SceneName> {
        let scenes = self.scenes.iter();
        let idle = scenes.filter(|(_, scene)| scene.heard.elapsed() >= self.idle_timeout);
        idle.filter_map(|(name, _)| name.clone()).collect()
    }

    /// Forgets the [idle](Self::idle) scenes and their memories.
    fn forget_idle(&mut self) {
        for scene in self.idle() {
            self.forget(Some(&scene));
        }
    }

    /// Number of windows that wait for a forecast.
    pub fn waiting(&self) -> usize {
        self.waiting.len()
    }

    /// Number of windows that were not forecast, because a window of a later frame replaced them.
    pub fn dropped(&self) -> u64 {
        self.dropped
    }

    /// The known scene with the most [dropped](Self::dropped) windows, and their number.
    pub fn most_dropped(&self) -> Option<(&SceneName, u64)> {
        let scenes = self.scenes.iter();
        let named = scenes.filter_map(|(name, scene)| Some((name.as_ref()?, scene.dropped)));
        named.filter(|(_, dropped)| *dropped > 0).max_by_key(|(_, dropped)| *dropped)
    }

    /// Removes the oldest windows from the queue: as many as have together at most `pedestrians` pedestrians, and at
    /// least one.
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
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_kept_is_bounded() {
        let name = |scene: &str| SceneName::new(scene).unwrap();
        let mut scenes = LiveScenes::new(LiveTracks::new());
        for scene in 0..LiveScenes::MOST_SCENES {
            scenes.observe(Some(&name(&scene.to_string())), 0, []).unwrap();
        }
        let error = scenes.observe(Some(&name("more")), 0, []).unwrap_err().to_string();
        assert!(error.contains("more than 2000") && error.contains("10 minutes"), "{error}");
        // Scenes without a frame are forgotten at once.
        scenes.idle_timeout = Duration::ZERO;
        scenes.observe(Some(&name("more")), 0, []).unwrap();
        assert_eq!(scenes.idle(), [name("more")]);
        let mut scenes = LiveScenes::new(LiveTracks::new());
        let seen = [(PedestrianId(1), [0.0, 0.0])];
        let waiting = LiveScenes::MOST_WAITING as i64;
        for frame in 0..waiting + 7 {
            scenes.observe(None, frame, seen).unwrap();
        }
        let error = scenes.observe(None, waiting + 7, seen).unwrap_err().to_string();
        assert!(error.contains("10000 frames wait"), "{error}");
        scenes.next_batch(1);
        scenes.observe(None, waiting + 7, seen).unwrap();
        let mut scenes = LiveScenes::new(LiveTracks::new());
        let crowd = |scene: i64| (0..100_000).map(move |id| (PedestrianId(id), [scene as f64, 0.0]));
        for scene in 0..4 {
            scenes.observe(Some(&name(&scene.to_string())), 0, crowd(scene)).unwrap();
        }
        let error = scenes.observe(Some(&name("4")), 0, crowd(4)).unwrap_err().to_string();
        assert!(error.contains("more than 400000 pedestrians"), "{error}");
    }
}
