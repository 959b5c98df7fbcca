//! Values that pass between Rust and JavaScript, as JSON.

use serde::de::DeserializeOwned;
use std::error::Error;
use wasm_bindgen::prelude::*;

pub(crate) type Failure = Box<dyn Error>;

/// An object of JavaScript; the default of its type where there is none.
pub(crate) fn read<T: DeserializeOwned + Default>(value: &JsValue) -> Result<T, Failure> {
    if value.is_undefined() || value.is_null() {
        return Ok(T::default());
    }
    let text = js_sys::JSON::stringify(value).map_err(|_| "the options are no plain object")?;
    serde_json::from_str(&String::from(text)).map_err(|error| format!("options: {error}").into())
}

/// JSON as an object of JavaScript.
pub(crate) fn parse(json: &str) -> Result<JsValue, Failure> {
    js_sys::JSON::parse(json).map_err(|_| "an answer is no JSON".into())
}

/// An error and its causes, each once, as an `Error` of JavaScript.
pub(crate) fn thrown(failure: &dyn Error) -> JsError {
    let mut words = failure.to_string();
    let mut cause = failure.source();
    while let Some(error) = cause {
        if !words.contains(&error.to_string()) {
            words = format!("{words}: {error}");
        }
        cause = error.source();
    }
    JsError::new(&words)
}

/// `Answer` of `types.d.ts`, of JSON lines.
pub(crate) fn answer(notes: &[String], lines: &str) -> Result<JsValue, Failure> {
    let notes = serde_json::to_string(notes)?;
    let forecasts: Vec<&str> = lines.lines().collect();
    parse(&format!(
        "{{\"notes\":{notes},\"forecasts\":[{}]}}",
        forecasts.join(",")
    ))
}
