//! What the page shows of a file.

use crate::exchange::{Failure, parse};
use crate::model::model;
use crate::options::BrowserOptions;
use crate::tracks::{self, FileTracks};
use ddl::RecordingPlayer;
use ddl::data::Summary;
use serde::Serialize;
use wasm_bindgen::JsValue;

/// Largest number of moments to play, as of `ddl view`.
const MOMENTS: usize = 60;

/// `View` of `types.d.ts`.
#[derive(Serialize)]
struct PageView {
    data: Summary,
    page: String,
    place: String,
    notes: Vec<String>,
    lines: String,
}

/// The page of `ddl view` with its forecasts as JSON lines, a picture of the place, and what the program tells.
pub(crate) fn view(name: &str, bytes: &[u8], options: &BrowserOptions) -> Result<JsValue, Failure> {
    let tracks = FileTracks::read(name, bytes, options)?;
    let (observed, model) = (&tracks.observed, model()?);
    let player = RecordingPlayer {
        model: &model,
        recording: &observed.recording,
        windows: &observed.windows,
        most: options.moments.unwrap_or(MOMENTS).max(1),
    };
    let windows = tracks.windows(player.shown(), options)?;
    let answers = tracks::answers(&windows, options)?;
    let (lines, notes) = tracks.lines(&windows, &answers, options)?;
    let view = PageView {
        data: observed.recording.summary(),
        page: player.to_html(&answers, name, observed.warning.as_ref(), observed.clock)?,
        place: tracks.place()?,
        notes,
        lines,
    };
    parse(&serde_json::to_string(&view)?)
}
