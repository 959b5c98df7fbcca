//! What tables and errors call the model.

pub(crate) const NAME: &str = "DDL";
/// What is different without the tracks that goals are retrieved from.
pub(crate) const WITHOUT_LIBRARY: &str = "without an expert library";
