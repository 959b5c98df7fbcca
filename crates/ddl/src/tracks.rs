//! Tracks of a file and answers about them: what every program that reads files says and writes.

pub(crate) mod json_lines;
pub(crate) mod moment;
pub(crate) mod observed;
pub(crate) mod timed;
pub(crate) mod unfamiliar;
pub(crate) mod windows;
