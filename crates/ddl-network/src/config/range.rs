//! Range checks of configuration values.

use crate::NetworkError;

pub(super) fn require(
    holds: bool,
    field: &'static str,
    value: &dyn std::fmt::Display,
    rule: &'static str,
) -> Result<(), NetworkError> {
    if holds { Ok(()) } else { Err(NetworkError::Config { field, value: value.to_string(), rule }) }
}

pub(super) fn at_least_one(field: &'static str, value: u64) -> Result<(), NetworkError> {
    require(value > 0, field, &value, "at least 1")
}

pub(super) fn positive(field: &'static str, value: f64) -> Result<(), NetworkError> {
    require(value.is_finite() && value > 0.0, field, &value, "finite and positive")
}

pub(super) fn not_negative(field: &'static str, value: f64) -> Result<(), NetworkError> {
    require(value.is_finite() && value >= 0.0, field, &value, "finite and not negative")
}
