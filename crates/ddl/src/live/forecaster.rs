//! Forecasts of one scene, frame by frame.

use crate::error::DdlError;
use crate::forecast::certified::{self, CertifiedForecast};
use crate::forecast::joint::GivenPlan;
use crate::live::place_memory::PlaceMemory;
use crate::live::watch::Watch;
use crate::model::ddl::Ddl;
use ddl_core::{AdaptiveRegions, Forecast, ForecastError, Forecaster, PedestrianId, PedestrianNames, Position, Window};
use ddl_data::LiveTracks;
use ddl_memory::SceneMemory;
use std::borrow::Borrow;

/// A forecaster for a live stream of frames, 0.4 s apart or faster, that keeps the observed tracks itself.
///
/// Every [`push`](Self::push) forecasts all pedestrians that have been observed at 8 consecutive time steps, or as a
/// [`Completeness`](ddl_data::Completeness) asks for. The forecast has the bits of [`Forecaster::forecast`] on the
/// window that [`Recording::observed_windows`](ddl_data::Recording::observed_windows) cuts from all frames so far.
/// With a memory, this window also holds the recalled tracks. Adaptive regions, with their weights, are the only other
/// difference. For gaps, see [`LiveTracks`]. The forecaster is owned or borrowed: with `LiveForecaster::new(&model)`,
/// one model serves several places.
///
/// # State kept between frames
/// It keeps the last 8 time steps of the pedestrians that are present, so the memory use is bounded by their number.
/// [On request](Self::remembering) it keeps the memory of the place, which has a fixed capacity. With [adaptive
/// regions](Self::with_adaptive_regions) it also keeps the forecasts of the last 4.8 s. It keeps no state of the
/// networks: their tokens are relative to goals and to the scene, which change at every frame.
///
/// # Errors
/// After an error of [`push`](Self::push) or [`push_certified`](LiveForecaster::push_certified) the state is unchanged:
/// the frame may be pushed again without the fault. A frame that is never pushed is a gap.
///
/// # Examples
/// Any [`Forecaster`] works, such as a loaded model:
/// ```
/// use ddl::data::PedestrianId;
/// use ddl::{BuiltinModel, Ddl, DeviceChoice, LiveForecaster};
///
/// let mut live = LiveForecaster::new(Ddl::builtin(BuiltinModel::default(), DeviceChoice::Cpu)?);
/// for frame in 0..7 {
///     assert!(live.push(frame, [(PedestrianId(1), [0.5 * frame as f64, 0.0])])?.is_none());
/// }
/// let now = live.push(7, [(PedestrianId(1), [3.5, 0.0]), (PedestrianId(2), [9.0, 0.0])])?;
/// let now = now.expect("pedestrian 1 has 8 frames");
/// assert_eq!((now.window.frames()[7], now.window.pedestrians()), (7, &[PedestrianId(1)][..]));
/// assert!(now.forecast.hypothesis(0, 0)[11][0] > 3.5, "it goes on");
/// # Ok::<(), ddl::DdlError>(())
/// ```
#[derive(Debug, Clone)]
pub struct LiveForecaster<M = Ddl> {
    model: M,
    watch: Watch,
    regions: Option<AdaptiveRegions>,
}

/// The forecast made at one frame.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct LiveForecast<F = Forecast> {
    /// The pedestrians, in the order of the forecast, with their last 8 positions.
    pub window: Window,
    /// A [`Forecast`], or a [`CertifiedForecast`].
    pub forecast: F,
}

impl<M> LiveForecaster<M> {
    /// A forecaster without tracks; frame numbers are time steps, 0.4 s apart.
    #[must_use]
    pub fn new(model: M) -> Self {
        Self::with_tracks(model, LiveTracks::new())
    }

    /// A forecaster with these tracks, which may have another clock, or also hold pedestrians that were tracked for
    /// less than 8 steps. [`Window::quality`] says how well each pedestrian was observed.
    #[must_use]
    pub fn with_tracks(model: M, tracks: LiveTracks) -> Self {
        Self { model, watch: Watch::new(tracks), regions: None }
    }

    /// Adapts regions and weights to the observations of this place; see [`AdaptiveRegions`]. All other parts of the
    /// forecasts have the same bits.
    #[must_use]
    pub fn with_adaptive_regions(self, regions: AdaptiveRegions) -> Self {
        Self { regions: Some(regions), ..self }
    }

    /// The adaptive regions; `None` unless requested.
    pub fn regions(&self) -> Option<&AdaptiveRegions> {
        self.regions.as_ref()
    }

    /// Forgets all tracks and the last frame, as when a tracker restarts: any frame may follow. The memory of the place
    /// and the adapted regions are kept.
    pub fn clear(&mut self) {
        self.watch.clear();
        if let Some(regions) = &mut self.regions {
            regions.clear();
        }
    }

    /// Names pedestrians of the next frame. Its window has these names.
    pub fn name(&mut self, names: &PedestrianNames) {
        self.watch.tracks.name(names);
    }

    /// The memory of the place, for its [memory file](crate::MemoryFile); `None` unless
    /// [requested](LiveForecaster::remembering).
    pub fn place(&self) -> Option<&PlaceMemory> {
        self.watch.place.as_ref()
    }

    /// The tracks of the frames so far.
    pub fn tracks(&self) -> &LiveTracks {
        &self.watch.tracks
    }

    /// Adds a frame, and forecasts with `forecast` if there are pedestrians to forecast. After an error nothing has
    /// changed.
    fn push_with<F>(
        &mut self,
        frame: i64,
        pedestrians: impl IntoIterator<Item = (PedestrianId, Position)>,
        forecast: impl FnOnce(&M, &Window) -> Result<F, ForecastError>,
    ) -> Result<Option<LiveForecast<F>>, DdlError> {
        let pedestrians = pedestrians.into_iter().collect();
        let model = &self.model;
        let made = self.watch.push(frame, pedestrians, |window| forecast(model, window))?;
        Ok(made.map(|(window, forecast)| LiveForecast { window, forecast }))
    }

    fn adapted(&mut self, window: &Window, forecast: Forecast) -> Forecast {
        match &mut self.regions {
            Some(regions) => regions.adapt(window, forecast),
            None => forecast,
        }
    }
}

impl<M: Forecaster> LiveForecaster<M> {
    /// Adds a frame, with the positions (m) of all pedestrians in any order. Forecasts the pedestrians observed at 8
    /// consecutive time steps; `None` if there are none.
    ///
    /// # Errors
    /// [`DdlError::Live`] for a frame out of order, a position that is not finite or a repeated pedestrian;
    /// [`DdlError::Forecast`] when the forecast fails, for instance because positions are too large.
    pub fn push(
        &mut self,
        frame: i64,
        pedestrians: impl IntoIterator<Item = (PedestrianId, Position)>,
    ) -> Result<Option<LiveForecast>, DdlError> {
        let now = self.push_with(frame, pedestrians, M::forecast)?;
        Ok(now.map(|LiveForecast { window, forecast }| {
            let forecast = self.adapted(&window, forecast);
            LiveForecast { window, forecast }
        }))
    }
}

impl<M: Borrow<Ddl>> LiveForecaster<M> {
    /// Adds a memory of the place: one from a file ([`SceneMemory::read`]), or an empty one. The paths of
    /// earlier pedestrians then influence the forecasts, and the memory grows with every frame.
    ///
    /// A forecast uses observations before its frame. A memory of at least 500 segments is tested on the first
    /// pedestrians. If it is of another place, it is [refused](PlaceMemory::refused), and an empty one replaces it.
    ///
    /// # Errors
    /// When the model has no memory branch, or the memory has another number of raw frames per step.
    pub fn remembering(mut self, memory: Option<SceneMemory>) -> Result<Self, DdlError> {
        self.watch.remember(self.model.borrow(), memory)?;
        Ok(self)
    }

    /// Like [`push`](Self::push), with the [joint futures](Ddl::forecast_scenes) of the scene, whose pedestrians
    /// respond to a plan if there is one. Regions and weights do not adapt.
    ///
    /// # Errors
    /// As [`push`](Self::push).
    pub fn push_joint(
        &mut self,
        frame: i64,
        pedestrians: impl IntoIterator<Item = (PedestrianId, Position)>,
        given: Option<&GivenPlan>,
    ) -> Result<Option<LiveForecast>, DdlError> {
        self.push_with(frame, pedestrians, |model, window| {
            let windows = std::slice::from_ref(window);
            Ok(model.borrow().forecast_scenes(windows, given)?.remove(0))
        })
    }

    /// Like [`push`](Self::push), with evidence for every hypothesis that it approaches its goal: the result of
    /// [`Ddl::forecast_certified`] for the window.
    ///
    /// # Errors
    /// As [`push`](Self::push); for the variants without dynamics
    /// [`CertificateError::NoFlow`](crate::CertificateError::NoFlow) from the first frame on.
    pub fn push_certified(
        &mut self,
        frame: i64,
        pedestrians: impl IntoIterator<Item = (PedestrianId, Position)>,
    ) -> Result<Option<LiveForecast<CertifiedForecast>>, DdlError> {
        certified::ensure_flow(self.model.borrow().config().star.variant)?;
        let now = self.push_with(frame, pedestrians, |model, window| {
            let windows = std::slice::from_ref(window);
            Ok(model.borrow().forecast_certified(windows)?.remove(0))
        })?;
        Ok(now.map(|LiveForecast { window, forecast }| {
            let certified = forecast;
            let forecast = self.adapted(&window, certified.forecast);
            let forecast = CertifiedForecast { forecast, ..certified };
            LiveForecast { window, forecast }
        }))
    }
}
