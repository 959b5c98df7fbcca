//! A trained model, and where it is taken from.

pub(crate) mod builtin;
pub(crate) mod ddl;
mod loading;
pub(crate) mod packed;
mod packing;
pub(crate) mod source;
