//! What the pictures of the documentation have in common: a sheet, axes, and how walks are drawn.

pub(crate) mod axes;
pub(crate) mod marks;
pub(crate) mod sheet;
