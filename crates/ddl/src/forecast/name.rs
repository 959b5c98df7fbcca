//! What tables and errors call the model.

pub(crate) const NAME: &str = "DDL";
pub(crate) const WITHOUT_LIBRARY: &str = "without an expert library";
