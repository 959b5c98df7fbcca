#![doc = include_str!("../README.md")]

mod exchange;
mod live;
mod model;
mod options;
mod tracks;
mod view;

use exchange::{Failure, answer, thrown};
use js_sys::Uint8Array;
use options::BrowserOptions;
use tracks::FileTracks;
use wasm_bindgen::prelude::*;

/// Types that wasm-bindgen cannot derive.
#[wasm_bindgen(typescript_custom_section)]
const TYPES: &str = include_str!("types.d.ts");

/// Forecasts of every moment of a file.
///
/// `name` is the name of the file, `bytes` its content; the format is recognised.
///
/// # Errors
/// The error of the program, as text.
#[wasm_bindgen(unchecked_return_type = "Answer")]
pub fn forecast(
    #[wasm_bindgen(unchecked_param_type = "string")] name: &JsValue,
    #[wasm_bindgen(unchecked_param_type = "Uint8Array")] bytes: &JsValue,
    #[wasm_bindgen(unchecked_optional_param_type = "Options")] options: &JsValue,
) -> Result<JsValue, JsError> {
    asked(options, |options| {
        let name = name.as_string().ok_or("the name of the file is no string")?;
        let bytes = bytes.dyn_ref::<Uint8Array>().ok_or("the bytes of the file are no Uint8Array")?;
        let tracks = FileTracks::read(&name, &bytes.to_vec(), &options)?;
        let windows = tracks.windows(tracks.observed.windows.clone(), &options)?;
        let answers = tracks::answers(&windows, &options)?;
        let (lines, told) = tracks.lines(&windows, &answers, &options)?;
        answer(&told, &lines, true)
    })
}

/// What the page shows: the page of `ddl view`, a picture of the place, the forecasts as JSON lines.
///
/// # Errors
/// As [`forecast`].
#[wasm_bindgen(unchecked_return_type = "View")]
pub fn view(
    name: &str,
    bytes: &[u8],
    #[wasm_bindgen(unchecked_optional_param_type = "Options")] options: &JsValue,
) -> Result<JsValue, JsError> {
    asked(options, |options| view::view(name, bytes, &options))
}

/// An answer by these options.
fn asked(
    options: &JsValue,
    answer: impl FnOnce(BrowserOptions) -> Result<JsValue, Failure>,
) -> Result<JsValue, JsError> {
    exchange::word_settings();
    exchange::read(options, &[]).and_then(answer).map_err(|failure| thrown(&*failure))
}
