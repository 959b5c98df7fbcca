//! The name of the model in tables and errors.

pub(crate) const NAME: &str = "DDL";
pub(crate) const WITHOUT_LIBRARY: &str = "without an expert library";
