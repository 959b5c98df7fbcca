//! Tracks of a file and answers about them: what every program that reads files says and writes.

#[cfg(feature = "files")]
pub(crate) mod csv_table;
pub(crate) mod json_lines;
pub(crate) mod moment;
pub(crate) mod observed;
pub(crate) mod past;
pub(crate) mod timed;
pub(crate) mod unfamiliar;
pub(crate) mod wanted_regions;
pub(crate) mod windows;
