//! What a document is made of.

use super::table::Table;

/// Headings, paragraphs, warnings and tables in the order in which they are read.
///
/// In every text, `words between backticks` are code; nothing else is marked up.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Document {
    /// What must be known before anything else is read: the first line.
    pub lead: String,
    /// The title.
    pub title: String,
    /// Everything else.
    pub parts: Vec<Part>,
}

/// A piece of a [`Document`].
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Part {
    /// A heading; level 1 stands below the title.
    Heading {
        /// 1, 2, ...
        level: usize,
        /// The words.
        text: String,
    },
    /// Running text.
    Paragraph(String),
    /// Items of a list.
    List(Vec<String>),
    /// What a reader must not miss.
    Warning(String),
    /// Numbers.
    Table(Table),
    /// Parts for those who want to know more: folded away where the form allows it.
    Details {
        /// What is in them.
        summary: String,
        /// The parts; not of level 1, and no details themselves.
        parts: Vec<Part>,
    },
}

impl Part {
    /// A heading below the title.
    pub fn heading(text: impl Into<String>) -> Self {
        Self::Heading {
            level: 1,
            text: text.into(),
        }
    }

    /// A heading below [`Part::heading`].
    pub fn subheading(text: impl Into<String>) -> Self {
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
