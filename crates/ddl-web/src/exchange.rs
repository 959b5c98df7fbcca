//! Values that pass between Rust and JavaScript, as JSON.

use js_sys::{Array, Object};
use serde::de::DeserializeOwned;
use serde_json::{Map, Value};
use std::error::Error;
use wasm_bindgen::prelude::*;

pub(crate) type Failure = Box<dyn Error>;

/// An object of JavaScript without fields `of_files`; the default of its type where there is none.
pub(crate) fn read<T: DeserializeOwned + Default>(value: &JsValue, of_files: &[&str]) -> Result<T, Failure> {
    if value.is_undefined() || value.is_null() {
        return Ok(T::default());
    }
    let text = js_sys::JSON::stringify(value).map_err(|_| "the options are no plain object")?;
    let wrong = |error| format!("options: {error}");
    let given: Map<String, Value> = serde_json::from_str(&String::from(text)).map_err(wrong)?;
    if let Some(name) = of_files.iter().find(|name| given.contains_key(**name)) {
        return Err(format!("{name} is an option of files; Live has no use for it").into());
    }
    // JSON has null for NaN and infinite numbers.
    let is_null = |value: &Value| value.is_null() || value.as_array().is_some_and(|all| all.contains(&Value::Null));
    if let Some((name, _)) = given.iter().find(|(_, value)| is_null(value)) {
        return Err(format!("{name} is null or no finite number; leave it out for the default").into());
    }
    Ok(serde_json::from_value(given.into()).map_err(wrong)?)
}

/// Says how settings are written here: `maxAge`, `fps: 25`.
pub(crate) fn word_settings() {
    ddl::word_settings(|name, value| {
        let mut parts = name.split('_');
        let first = parts.next().unwrap_or_default().to_owned();
        let capital = |part: &str| part[..1].to_uppercase() + &part[1..];
        let name = parts.fold(first, |name, part| name + &capital(part));
        value.map_or(name.clone(), |value| match value.parse::<f64>() {
            Ok(_) => format!("{name}: {value}"),
            Err(_) => format!("{name}: {value:?}"),
        })
    });
}

/// JSON as an object of JavaScript.
pub(crate) fn parse(json: &str) -> Result<JsValue, Failure> {
    js_sys::JSON::parse(json).map_err(|_| "an answer is no JSON".into())
}

/// An error and its causes, each once, as an `Error` of JavaScript.
pub(crate) fn thrown(failure: &dyn Error) -> JsError {
    JsError::new(&ddl::with_causes(failure))
}

/// `Answer` of `types.d.ts`, of JSON lines. All of them may exceed the longest string of JavaScript.
pub(crate) fn answer(notes: &[String], lines: &str, is_due: bool) -> Result<JsValue, Failure> {
    let notes = serde_json::to_string(notes)?;
    let answer: Object = parse(&format!("{{\"due\":{is_due},\"notes\":{notes}}}"))?.unchecked_into();
    let forecasts = lines.lines().map(parse).collect::<Result<Array, _>>()?;
    js_sys::Reflect::set(&answer, &"forecasts".into(), &forecasts).map_err(|_| "an answer is no object")?;
    Ok(answer.into())
}
