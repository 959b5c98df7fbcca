//! The tracks of one place, frame by frame.

use crate::answer::{Answer, Held, Notes};
use crate::boundary::Failure;
use crate::layout::ddl_live_options;
use crate::model::{Model, Request, Threads};
use ddl::data::{Clock, LiveTracks, PedestrianId, Position, TimeUnit};
use ddl::{AdaptiveRegions, Ddl, DdlError, LiveForecast, LiveForecaster, MemoryFile};
use std::path::Path;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// Whole numbers below it are exact.
const LARGEST: f64 = (1_u64 << 53) as f64;
/// The unit that error messages give after a time.
const OF_TIMES: &str = " s (frames are microseconds)";

#[derive(Debug)]
pub(crate) struct Live {
    place: Mutex<Place>,
    threads: Arc<Threads>,
    /// Whether frames have times in seconds, not numbers.
    has_times: bool,
}

#[derive(Debug)]
struct Place {
    live: LiveForecaster<Arc<Ddl>>,
    file: Option<MemoryFile>,
}

impl Live {
    pub(crate) fn new(model: &Model, options: &ddl_live_options<'_>, memory: Option<&str>) -> Result<Self, Failure> {
        let live = LiveForecaster::with_tracks(Arc::clone(&model.ddl), tracks(options)?);
        let mut live = live.with_adaptive_regions(AdaptiveRegions::default());
        let mut file = None;
        if let Some(path) = memory {
            let (opened, read) = MemoryFile::open(Path::new(path)).map_err(Failure::file)?;
            live = live.remembering(read).map_err(Failure::file)?;
            file = Some(opened);
        }
        Ok(Self {
            place: Mutex::new(Place { live, file }),
            threads: Arc::clone(&model.threads),
            has_times: options.rate == 0.0,
        })
    }

    /// Adds a frame and writes its forecast to `answer`, without pedestrians if none can be forecast. Between two
    /// forecasts, `answer` keeps the previous one.
    pub(crate) fn observe(
        &self,
        at: f64,
        seen: Vec<(PedestrianId, Position)>,
        request: &Request,
        answer: &mut Answer,
    ) -> Result<(), Failure> {
        let frame = if self.has_times { (1e6 * at).round() } else { at };
        // False for NaN.
        if !(frame.fract() == 0.0 && frame.abs() < LARGEST) {
            let right = "it must be a number of seconds below 9e9, or with `rate` a frame number below 2^53";
            return Err(Failure::invalid(format!("the moment is {at}; {right}")));
        }
        let unit = if self.has_times { OF_TIMES } else { "" };
        let failed = |error: DdlError| Failure::invalid(format!("at {at}{unit}: {error}"));
        let mut place = self.held();
        let place = &mut *place;
        let made = self.threads.run(|| place.push(frame as i64, seen, request).map_err(failed))?;
        let held = made.map(|now| Held {
            window: now.window,
            forecast: now.forecast,
            is_joint: matches!(request, Request::Joint(_)),
            has_plan: matches!(request, Request::Joint(Some(_))),
            threads: Arc::clone(&self.threads),
        });
        if place.live.tracks().is_moment() {
            answer.hold(held, &place.notes());
        } else {
            answer.keep(&place.notes());
        }
        Ok(())
    }

    pub(crate) fn clear(&self) {
        self.held().live.clear();
    }

    /// Writes the memory and closes its file. The error says why the file is unchanged.
    pub(crate) fn close(&self) -> Result<(), Failure> {
        let mut place = self.held();
        let Place { live, file } = &mut *place;
        let unchanged = match (file.as_mut(), live.place()) {
            (Some(file), Some(memory)) => file.end(memory.clone()).map_err(Failure::file)?,
            _ => None,
        };
        *file = None;
        unchanged.map_or(Ok(()), |reason| Err(Failure::file(reason)))
    }

    /// A panic has left the tracks as they were before the frame.
    fn held(&self) -> MutexGuard<'_, Place> {
        self.place.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

fn tracks(options: &ddl_live_options<'_>) -> Result<LiveTracks, Failure> {
    let ddl_live_options { rate, whole, every, max_age, .. } = *options;
    if !(rate >= 0.0 && rate.is_finite()) {
        return Err(Failure::invalid(format!("rate is {rate}; it must be frames per second, or 0 for times")));
    }
    let clock = match rate {
        0.0 => Clock::with_stamps(TimeUnit::Seconds),
        rate => Clock::with_frame_time(rate.recip()).map_err(Failure::invalid)?,
    };
    let ages = [max_age.copied(), Some(every)];
    ddl::windows_of(LiveTracks::with_clock(clock), whole, ages, false).map_err(Failure::invalid)
}

impl Place {
    fn push(
        &mut self,
        frame: i64,
        seen: Vec<(PedestrianId, Position)>,
        request: &Request,
    ) -> Result<Option<LiveForecast>, DdlError> {
        match request {
            Request::Hypotheses => self.live.push(frame, seen),
            Request::Joint(given) => self.live.push_joint(frame, seen, given.as_ref()),
        }
    }

    /// What there is to say besides the forecast. Once a minute the memory is written.
    fn notes(&mut self) -> Notes<'_> {
        let place = self.live.place();
        let refused = place.and_then(|place| place.refused().map(str::to_owned));
        // The frame has been observed, so a full disk must not discard its forecast.
        let written = MemoryFile::write_if_due(self.file.as_mut(), place);
        let warning = written.err().map(|error| error.to_string()).or(refused);
        Notes {
            misfits: self.live.tracks().misfits(),
            remembered: place.map_or(0, |place| place.memory().segments()),
            warning,
        }
    }
}
