//! The parts of a document.

use crate::document::table::Table;

/// Headings, paragraphs, warnings and tables in reading order.
///
/// In every text, `words between backticks` are code; there is no other markup.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub(crate) struct Document {
    /// The first line, such as the data convention of the numbers.
    pub(crate) lead: String,
    pub(crate) title: String,
    /// The content below the title.
    pub(crate) parts: Vec<Part>,
}

/// A piece of a [`Document`].
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum Part {
    /// A heading below the title.
    Heading(String),
    /// A heading below [`Part::Heading`].
    Subheading(String),
    /// Running text.
    Paragraph(String),
    List(Vec<String>),
    Warning(String),
    Table(Table),
    /// Further parts, collapsed in HTML.
    Details {
        /// The visible line that names the content.
        summary: String,
        /// The parts: no heading but subheadings, no details.
        parts: Vec<Part>,
    },
}

impl Part {
    pub(crate) fn heading(text: impl Into<String>) -> Self {
        Self::Heading(text.into())
    }

    pub(crate) fn subheading(text: impl Into<String>) -> Self {
        Self::Subheading(text.into())
    }
}
