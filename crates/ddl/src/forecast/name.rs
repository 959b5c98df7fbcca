//! The name of the model in tables and errors.

pub(crate) const NAME: &str = "DDL";
