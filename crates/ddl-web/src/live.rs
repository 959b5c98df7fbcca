//! Live forecasts of an observed place.

use crate::exchange::{self, Failure, answer, thrown};
use crate::model;
use crate::options::Options;
use crate::tracks::lines;
use ddl::data::{Clock, LiveTracks, Misfit, PedestrianId, TimeUnit};
use ddl::{AdaptiveRegions, Ddl, LiveForecaster, UnfamiliarMotions};
use std::sync::Arc;
use wasm_bindgen::prelude::*;

/// Microseconds in a second: times are counted in them.
const MICROSECONDS: f64 = 1e6;
/// The unit that error messages give after a time.
const OF_TIMES: &str = " s (frames are microseconds)";
/// Options that `LiveOptions` of `types.d.ts` leaves out.
const OF_FILES: [&str; 6] = ["homography", "columns", "keep", "unit", "last", "moments"];

/// Forecasts of one place, frame by frame.
#[wasm_bindgen]
#[derive(Debug)]
pub struct Live {
    forecaster: LiveForecaster<Arc<Ddl>>,
    options: Options,
    clock: Clock,
    /// Whether moments are times in seconds, and not frame numbers.
    are_times: bool,
    motions: UnfamiliarMotions,
}

#[wasm_bindgen]
impl Live {
    /// A place without tracks. With `fps` (or `dt`, `frameStep`) moments are frame numbers, without it seconds.
    ///
    /// # Errors
    /// An option that is out of range.
    #[wasm_bindgen(constructor)]
    pub fn new(
        #[wasm_bindgen(unchecked_optional_param_type = "LiveOptions")] options: &JsValue,
    ) -> Result<Self, JsError> {
        Self::open(options).map_err(|failure| thrown(&*failure))
    }

    fn open(options: &JsValue) -> Result<Self, Failure> {
        let options: Options = exchange::read(options, &OF_FILES)?;
        let given = options.units()?.clock()?;
        let clock = given.unwrap_or_else(|| Clock::with_stamps(TimeUnit::Seconds));
        let tracks = options.windows_of(LiveTracks::with_clock(clock))?;
        let mut forecaster = LiveForecaster::with_tracks(model()?, tracks);
        if options.memory {
            forecaster = forecaster.remembering(None)?;
        }
        if !options.regions()?.is_empty() {
            forecaster = forecaster.with_adaptive_regions(AdaptiveRegions::default());
        }
        Ok(Self { forecaster, options, clock, are_times: given.is_none(), motions: UnfamiliarMotions::default() })
    }

    /// Adds a moment, in order of time: `ids` of its pedestrians, and `xy`, the x and y of each in turn, metres.
    /// Returns the forecasts from it; none without pedestrians to forecast, or where none is due yet (`every`).
    ///
    /// # Errors
    /// A moment out of order, a position that is not finite, a repeated pedestrian; the state is then unchanged.
    #[wasm_bindgen(unchecked_return_type = "Answer")]
    pub fn observe(&mut self, moment: f64, ids: &[f64], xy: &[f64]) -> Result<JsValue, JsError> {
        self.push(moment, ids, xy).map_err(|failure| thrown(&*failure))
    }

    fn push(&mut self, moment: f64, ids: &[f64], xy: &[f64]) -> Result<JsValue, Failure> {
        let (positions, rest) = xy.as_chunks::<2>();
        if positions.len() != ids.len() || !rest.is_empty() {
            return Err(format!("{} ids but {} numbers in xy; give two for each id", ids.len(), xy.len()).into());
        }
        let frame = if self.are_times { (MICROSECONDS * moment).round() } else { moment };
        let is_exact = |number: f64| number.fract() == 0.0 && number.abs() < 1.0 / f64::EPSILON;
        if let Some(id) = ids.iter().find(|id| !is_exact(**id)) {
            return Err(format!("ids must be whole numbers below 2^52, not {id}").into());
        }
        if !is_exact(frame) {
            let right = "it must be a number of seconds below 4e9, or with fps a frame number below 2^52";
            return Err(format!("the moment is {moment}; {right}").into());
        }
        let frame = frame as i64;
        let seen = ids.iter().zip(positions).map(|(id, position)| (PedestrianId(*id as i64), *position));
        let now = if self.options.joint {
            self.forecaster.push_joint(frame, seen, None)
        } else {
            self.forecaster.push(frame, seen)
        };
        let unit = if self.are_times { OF_TIMES } else { "" };
        let now = now.map_err(|error| format!("at {moment}{unit}: {error}"))?;
        let clock = self.clock;
        let misfits = Misfit::words(self.forecaster.tracks().misfits(), |misfit| {
            format!("pedestrian {} at {}", misfit.pedestrian.0, clock.number(misfit.tick))
        });
        let mut notes: Vec<String> = misfits.into_iter().map(|words| format!("warning: {words}")).collect();
        let text = match now {
            None => String::new(),
            Some(now) => {
                let (window, forecast) = ([now.window], [now.forecast]);
                lines(&window, &forecast, clock, &self.options, &mut self.motions)?
            }
        };
        notes.extend(self.motions.warning());
        answer(&notes, &text, self.forecaster.tracks().is_moment())
    }

    /// Forgets all tracks, as when a tracker restarts; the memory is kept.
    pub fn clear(&mut self) {
        self.forecaster.clear();
    }

    /// Number of segments in the memory of the place; 0 without a memory.
    pub fn remembered(&self) -> usize {
        self.forecaster.place().map_or(0, |place| place.memory().segments())
    }
}
