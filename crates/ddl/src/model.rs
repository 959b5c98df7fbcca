//! A trained model: loaded, applied and packed.

pub(crate) mod ddl;
mod loading;
mod packing;
