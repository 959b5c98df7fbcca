//! Forecasts of live tracks.

use crate::exchange::{self, Failure, answer, thrown};
use crate::model::model;
use crate::options::BrowserOptions;
use crate::tracks::lines;
use ddl::data::{Clock, LiveTracks, PedestrianId, TimeUnit};
use ddl::memory::PlaceMemory;
use ddl::{Ddl, Note, Session, SessionMemory, UnfamiliarMotions};
use std::sync::Arc;
use wasm_bindgen::prelude::*;

/// Options that `LiveOptions` of `types.d.ts` leaves out.
const OF_FILES: [&str; 6] = ["homography", "columns", "keep", "unit", "last", "moments"];

/// Forecasts of one place, frame by frame.
#[wasm_bindgen(js_name = Live)]
#[derive(Debug)]
pub struct BrowserPlace {
    session: Session<Arc<Ddl>>,
    options: BrowserOptions,
    clock: Clock,
    motions: UnfamiliarMotions,
}

#[wasm_bindgen(js_class = Live)]
impl BrowserPlace {
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
        exchange::word_settings();
        let options: BrowserOptions = exchange::read(options, &OF_FILES)?;
        let clock = options.units()?.clock()?.unwrap_or_else(|| Clock::with_stamps(TimeUnit::Seconds));
        let tracks = options.windows().tracks(LiveTracks::with_clock(clock))?;
        let memory = if options.memory { SessionMemory::Kept } else { SessionMemory::None };
        let session = Session::new(model()?, tracks, options.request()?)?.remembering(memory)?;
        Ok(Self { session, options, clock, motions: UnfamiliarMotions::default() })
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
        let is_exact = |number: f64| number.fract() == 0.0 && number.abs() < 1.0 / f64::EPSILON;
        if let Some(id) = ids.iter().find(|id| !is_exact(**id)) {
            return Err(format!("ids must be whole numbers below 2^52, not {id}").into());
        }
        let seen = ids.iter().zip(positions).map(|(id, position)| (PedestrianId(*id as i64), *position));
        let now = self.session.push_at(moment, seen)?;
        let text = match now.answer {
            None => String::new(),
            Some((window, answer)) => lines(&[window], &[answer], self.clock, &self.options, &mut self.motions)?,
        };
        let notes = now.notes.into_iter().chain(self.motions.warning());
        answer(&notes.map(|note: Note| note.line()).collect::<Vec<_>>(), &text, now.is_due)
    }

    /// Forgets all tracks, as when a tracker restarts; the memory is kept.
    pub fn clear(&mut self) {
        self.session.clear(None);
    }

    /// Number of segments in the memory of the place; 0 without a memory.
    pub fn remembered(&self) -> usize {
        self.session.place(None).map_or(0, |place: &PlaceMemory| place.memory().segments())
    }
}
