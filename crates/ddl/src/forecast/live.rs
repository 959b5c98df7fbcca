use crate::error::DdlError;
use crate::forecast::certified::{self, CertifiedForecast};
use crate::forecast::watch::Watch;
use crate::forecast::watched_place::{OtherPlace, WatchedPlace};
use crate::model::ddl::Ddl;
use ddl_data::{Completion, LiveTracks, OBSERVED, PedestrianId, Position, Window};
use ddl_eval::{AdaptiveRegions, Forecast, ForecastError, Forecaster};
use ddl_memory::SceneMemory;
use std::borrow::Borrow;

/// A forecaster that is fed one frame at a time, 0.4 s apart or faster, and remembers what it has to.
///
/// Once somebody has been seen for 8 steps in a row (or as often as a [`Completion`] asks for), every
/// [`push`](Self::push) forecasts everybody of whom that is true, with the bits of [`Forecaster::forecast`] on the
/// window that [`Recording::observed_windows`](ddl_data::Recording::observed_windows) cuts from all frames so far (with a memory:
/// on that window with what the memory recalls; with regions that adapt: all but the regions); of gaps, see [`LiveTracks`]. The forecaster is owned, or borrowed: `LiveForecaster::new(&model)` watches several places
/// with one model.
///
/// # What is kept from frame to frame
/// What was seen during the last 8 steps of those who are there, so that memory is bounded by the people present; and the
/// memory of the place, bounded by its capacity, where one is [asked for](Self::remembering).
/// Where [regions adapt](Self::adapting_regions), also the forecasts of the last 4.8 s.
/// Nothing of the networks: their tokens are relative to goals and to the scene, which are others at every frame.
///
/// # Errors
/// After an error of [`push`](Self::push) or [`push_certified`](LiveForecaster::push_certified) nothing has changed: the same
/// frame may be pushed again, without whatever was wrong with it. A frame never pushed is a gap.
///
/// # Examples
/// Any [`Forecaster`] can be fed so, a loaded model or constant velocity, which needs none:
/// ```
/// use ddl::LiveForecaster;
/// use ddl::data::PedestrianId;
/// use ddl::eval::baseline::ConstantVelocity;
///
/// let mut live = LiveForecaster::new(ConstantVelocity::last_step());
/// for frame in 0..7 {
///     assert!(live.push(frame, [(PedestrianId(1), [0.5 * frame as f64, 0.0])])?.is_none());
/// }
/// let now = live.push(7, [(PedestrianId(1), [3.5, 0.0]), (PedestrianId(2), [9.0, 0.0])])?;
/// let now = now.expect("pedestrian 1 has 8 frames");
/// assert_eq!((now.frame(), now.window.pedestrians()), (7, &[PedestrianId(1)][..]));
/// assert_eq!(now.forecast.hypothesis(0, 0)[11], [9.5, 0.0]);
/// # Ok::<(), ddl::DdlError>(())
/// ```
#[derive(Debug, Clone)]
pub struct LiveForecaster<M = Ddl> {
    model: M,
    watch: Watch,
    regions: Option<AdaptiveRegions>,
}

/// What is forecast from one frame on.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct LiveForecast<F = Forecast> {
    /// Who is forecast, in the order of the forecast, and their last 8 positions.
    pub window: Window,
    /// A [`Forecast`], or a [`CertifiedForecast`].
    pub forecast: F,
}

impl<F> LiveForecast<F> {
    /// The last frame observed, from which is forecast.
    pub fn frame(&self) -> i64 {
        self.window.frames()[OBSERVED - 1]
    }
}

impl<M> LiveForecaster<M> {
    /// Nobody seen yet; frames are counted, so that one step of 0.4 s is from one number to the next.
    #[must_use]
    pub fn new(model: M) -> Self {
        Self {
            model,
            watch: Watch::new(LiveTracks::new()),
            regions: None,
        }
    }

    /// Nobody seen yet, with another number of raw frames in a step of 0.4 s, such as 10 of a camera at 25 frames a second.
    ///
    /// # Errors
    /// [`DdlError::Live`] if the step does not lie in 1..=2^31.
    pub fn with_frame_step(model: M, frame_step: i64) -> Result<Self, DdlError> {
        let tracks = LiveTracks::with_frame_step(frame_step)?;
        Ok(Self {
            watch: Watch::new(tracks),
            ..Self::new(model)
        })
    }

    /// The same, with incomplete observations filled in as the completion allows; [`Window::made_up`] counts the filled-in
    /// positions.
    #[must_use]
    pub fn completing(mut self, completion: Completion) -> Self {
        self.watch.tracks = self.watch.tracks.completing(completion);
        self
    }

    /// The same, with regions that keep their share in this place: they follow what is seen, as [`AdaptiveRegions`] tells.
    /// Everything else of the forecasts has the same bits. What another watch of the place
    /// [learned](AdaptiveRegions::learned) is taken up by [`AdaptiveRegions::resuming`].
    #[must_use]
    pub fn adapting_regions(self, regions: AdaptiveRegions) -> Self {
        Self {
            regions: Some(regions),
            ..self
        }
    }

    /// The regions that adapt, where they were asked to.
    pub fn regions(&self) -> Option<&AdaptiveRegions> {
        self.regions.as_ref()
    }

    /// What forecasts.
    pub fn model(&self) -> &M {
        &self.model
    }

    /// Forgets everybody and the last frame: any frame may come next, as when a tracker starts anew. What is remembered of
    /// the place stays, and what regions have learned of it.
    pub fn clear(&mut self) {
        self.watch.clear();
        if let Some(regions) = &mut self.regions {
            regions.clear();
        }
    }

    /// What is remembered of the place, to be [saved](SceneMemory::write); `None` unless the forecaster was asked to
    /// [remember](LiveForecaster::remembering).
    pub fn memory(&self) -> Option<&SceneMemory> {
        self.place().map(WatchedPlace::memory)
    }

    /// Why the memory that was given is no longer used; `None` while it is.
    pub fn refused_memory(&self) -> Option<&OtherPlace> {
        self.place()?.refused()
    }

    /// The place that is remembered, for its [file](crate::MemoryFile).
    pub fn place(&self) -> Option<&WatchedPlace> {
        self.watch.place.as_ref()
    }

    /// Decides whether the memory that was given is of this place by those seen so far, where no more are to come
    /// ([`WatchedPlace::end_trial`]).
    pub fn end_trial(&mut self) {
        if let Some(place) = &mut self.watch.place {
            place.end_trial();
        }
    }

    /// What is remembered of the frames so far.
    pub fn tracks(&self) -> &LiveTracks {
        &self.watch.tracks
    }

    /// Adds a frame, and forecasts from it by `forecast` where there is somebody to forecast; all or nothing.
    fn push_with<F>(
        &mut self,
        frame: i64,
        people: impl IntoIterator<Item = (PedestrianId, Position)>,
        forecast: impl FnOnce(&M, &Window) -> Result<F, ForecastError>,
    ) -> Result<Option<LiveForecast<F>>, DdlError> {
        let people = people.into_iter().collect();
        let model = &self.model;
        let made = self
            .watch
            .push(frame, people, |window| forecast(model, window))?;
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
    /// Adds a frame, everybody's positions (m) in any order, and forecasts everybody seen for 8 steps in a row; `None` while
    /// that is nobody.
    ///
    /// # Errors
    /// [`DdlError::Live`] for a frame that is out of order, a position that is not finite or somebody twice;
    /// [`DdlError::Forecast`] when the forecast fails, for positions out of this world for instance.
    pub fn push(
        &mut self,
        frame: i64,
        people: impl IntoIterator<Item = (PedestrianId, Position)>,
    ) -> Result<Option<LiveForecast>, DdlError> {
        let now = self.push_with(frame, people, M::forecast)?;
        Ok(now.map(|LiveForecast { window, forecast }| {
            let forecast = self.adapted(&window, forecast);
            LiveForecast { window, forecast }
        }))
    }
}

impl<M: Borrow<Ddl>> LiveForecaster<M> {
    /// The same, with a memory of the place, such as [`SceneMemory::new`] or one that was [read](SceneMemory::read): what earlier
    /// pedestrians did where these are counts in the forecasts, and the memory grows with every frame.
    ///
    /// A forecast uses what was observed before its frame. A memory that already holds [`OtherPlace::FEWEST_STRETCHES`] is
    /// tried on the first pedestrians; where it is of another place, it is [refused](Self::refused_memory): forecasts go on
    /// with an empty one.
    ///
    /// # Errors
    /// When the model has no memory branch, or the memory another number of raw frames in a step.
    pub fn remembering(mut self, memory: SceneMemory) -> Result<Self, DdlError> {
        let place = WatchedPlace::new(self.model.borrow(), memory)?;
        self.watch.remember(place)?;
        Ok(self)
    }

    /// The same, with the evidence for every hypothesis that it goes to its goal: what [`Ddl::forecast_certified`] says of the
    /// window.
    ///
    /// # Errors
    /// As [`push`](Self::push); for the variants without dynamics
    /// [`CertificateError::NoFlow`](crate::CertificateError::NoFlow) from the first frame on.
    pub fn push_certified(
        &mut self,
        frame: i64,
        people: impl IntoIterator<Item = (PedestrianId, Position)>,
    ) -> Result<Option<LiveForecast<CertifiedForecast>>, DdlError> {
        certified::ensure_flow(self.model.borrow().config().star.variant)?;
        let now = self.push_with(frame, people, |model, window| {
            let windows = std::slice::from_ref(window);
            // one window in, one forecast out
            Ok(model.borrow().forecast_certified(windows)?.remove(0))
        })?;
        Ok(now.map(|LiveForecast { window, forecast }| {
            let certified = forecast;
            let forecast = self.adapted(&window, certified.forecast);
            let forecast = CertifiedForecast {
                forecast,
                ..certified
            };
            LiveForecast { window, forecast }
        }))
    }
}
