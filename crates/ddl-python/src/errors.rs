//! Conversion of the crates' errors to Python exceptions.

use pyo3::exceptions::{
    PyFileNotFoundError, PyIsADirectoryError, PyKeyboardInterrupt, PyOSError, PyPermissionError, PyValueError,
};
use pyo3::prelude::*;
use std::error::Error;
use std::io::ErrorKind;

/// Raises a `ValueError` with this text unless the condition holds.
macro_rules! ensure {
    ($holds:expr, $($text:tt)+) => {
        if !$holds {
            return Err(pyo3::exceptions::PyValueError::new_err(format!($($text)+)));
        }
    };
}
pub(crate) use ensure;

/// An error of input or output becomes the `OSError` of its kind, every other error a `ValueError` with the same
/// message.
pub(crate) fn raised(error: impl Into<ddl::DdlError>) -> PyErr {
    let error = error.into();
    if matches!(error, ddl::DdlError::Interrupted) {
        return PyKeyboardInterrupt::new_err(());
    }
    if let ddl::DdlError::Data(ddl::data::DataError::NotFound { .. }) = error {
        return PyFileNotFoundError::new_err(error.to_string());
    }
    of_any(error)
}

/// As [`raised`], for errors of the other crates.
pub(crate) fn of_any(error: impl Error + 'static) -> PyErr {
    let mut cause: Option<&(dyn Error + 'static)> = Some(&error);
    while let Some(one) = cause {
        if let Some(io) = one.downcast_ref::<std::io::Error>() {
            let message = ddl::with_causes(&error);
            return match io.kind() {
                ErrorKind::NotFound => PyFileNotFoundError::new_err(message),
                ErrorKind::PermissionDenied => PyPermissionError::new_err(message),
                ErrorKind::IsADirectory => PyIsADirectoryError::new_err(message),
                _ => PyOSError::new_err(message),
            };
        }
        cause = one.source();
    }
    PyValueError::new_err(ddl::with_causes(&error))
}

/// The value that has this name.
pub(crate) fn parsed<T: std::str::FromStr<Err: Error + 'static>>(name: &str) -> PyResult<T> {
    name.parse().map_err(of_any)
}

/// Checks a distance in metres.
pub(crate) fn not_negative(name: &str, metres: f64) -> PyResult<()> {
    ensure!(metres >= 0.0 && metres.is_finite(), "{name} is {metres}; it must be a number of metres, 0 or more");
    Ok(())
}

/// Says how users of Python write settings: `max_age`, `fps=25`, `columns="frame=NAME"`.
pub(crate) fn word_settings() {
    ddl::word_settings(|name, value| match (name, value) {
        ("unseen", _) => "seen=False".to_owned(),
        (_, None) => name.to_owned(),
        (_, Some(value)) if value.parse::<f64>().is_ok() => format!("{name}={value}"),
        (_, Some(value)) => format!("{name}={value:?}"),
    });
}
