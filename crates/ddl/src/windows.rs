//! The windows that a model is evaluated or validated on.

pub(crate) mod test_set;
