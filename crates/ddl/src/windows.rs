//! The windows that a model is evaluated or validated on.

pub(crate) mod split;
pub(crate) mod test_set;
