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
    /// A heading; level 1 is the level below the title.
    Heading {
        /// Level, from 1.
        level: usize,
        text: String,
    },
    /// Running text.
    Paragraph(String),
    List(Vec<String>),
    Warning(String),
    Table(Table),
    /// Further parts, collapsed in HTML.
    Details {
        /// The visible line that names the content.
        summary: String,
        /// The parts: no heading of level 1, no details.
        parts: Vec<Part>,
    },
}

impl Part {
    /// A heading below the title.
    pub(crate) fn heading(text: impl Into<String>) -> Self {
        Self::Heading {
            level: 1,
            text: text.into(),
        }
    }

    /// A heading below [`Part::heading`].
    pub(crate) fn subheading(text: impl Into<String>) -> Self {
        Self::Heading {
            level: 2,
            text: text.into(),
        }
    }
}

pub(super) fn unfolded(parts: &[Part]) -> impl Iterator<Item = &Part> {
    parts.iter().flat_map(|part| match part {
        Part::Details { parts, .. } => parts.iter(),
        other => std::slice::from_ref(other).iter(),
    })
}

pub(super) enum Span<'a> {
    Plain(&'a str),
    Code(&'a str),
}

pub(super) fn spans(text: &str) -> Vec<Span<'_>> {
    let mut spans = Vec::new();
    let mut rest = text;
    while let Some((before, after)) = rest.split_once('`') {
        let Some((code, after)) = after.split_once('`') else {
            break;
        };
        spans.extend([Span::Plain(before), Span::Code(code)]);
        rest = after;
    }
    spans.push(Span::Plain(rest));
    spans
}
