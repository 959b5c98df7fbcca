//! Values that have to lie in a range.

use crate::NetworkError;

pub(super) fn require(
    holds: bool,
    field: &'static str,
    value: &dyn std::fmt::Display,
    rule: &'static str,
) -> Result<(), NetworkError> {
    if holds {
        Ok(())
    } else {
        Err(NetworkError::Config {
            field,
            value: value.to_string(),
            rule,
        })
    }
}
