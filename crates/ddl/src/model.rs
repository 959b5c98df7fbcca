//! A trained model and its sources.

pub(crate) mod builtin;
pub(crate) mod ddl;
mod loading;
pub(crate) mod packed;
mod packing;
pub(crate) mod source;
