//! A page of results before it has a form: what is said in which order, to be rendered as markdown, HTML or LaTeX.

mod html;
mod latex;
mod markdown;
mod parts;
mod table;

pub(crate) use html::{ContentsEntry, escape, identifier, inline, unused};
pub use parts::{Document, Part};
pub use table::Table;
