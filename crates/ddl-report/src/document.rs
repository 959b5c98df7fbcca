//! A page of results as a list of parts, rendered as markdown or HTML.

mod html;
mod markdown;
mod parts;
mod table;

pub(crate) use html::{ContentsEntry, inline, warning};
pub(crate) use parts::{Document, Part};
pub(crate) use table::Table;
