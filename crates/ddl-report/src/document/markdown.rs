//! A document as markdown.

use crate::document::parts::{Document, Part};

impl Document {
    /// The document as markdown with pipe tables.
    pub(crate) fn to_markdown(&self) -> String {
        let head = format!("{}\n\n# {}\n", self.lead, self.title);
        head + &all(&self.parts)
    }
}

fn all(parts: &[Part]) -> String {
    parts.iter().map(render).collect()
}

/// The part after an empty line.
fn render(part: &Part) -> String {
    match part {
        Part::Heading(text) => format!("\n## {text}\n"),
        Part::Subheading(text) => format!("\n### {text}\n"),
        Part::Paragraph(text) => format!("\n{text}\n"),
        Part::Warning(text) => format!("\n> **Warning.** {text}\n"),
        Part::List(items) => format!("\n- {}\n", items.join("\n- ")),
        Part::Details { parts, .. } => all(parts),
        Part::Table(table) => match &table.caption {
            Some(caption) => format!("\n{caption}\n\n{table}"),
            None => format!("\n{table}"),
        },
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::document::Table;

    #[test]
    fn parts_are_separated_by_empty_lines() {
        let mut table = Table::new(["a"]);
        table.row(["1"]);
        let document = Document {
            lead: "First.".to_owned(),
            title: "Title".to_owned(),
            parts: vec![
                Part::heading("One"),
                Part::List(vec!["x".to_owned(), "`y`".to_owned()]),
                Part::Warning("Mind.".to_owned()),
                Part::subheading("Two"),
                Part::Paragraph("Words.".to_owned()),
                Part::Table(table.captioned("In metres.")),
            ],
        };
        assert_eq!(
            document.to_markdown(),
            "First.\n\n# Title\n\n## One\n\n- x\n- `y`\n\n> **Warning.** Mind.\n\n### Two\n\nWords.\n\n\
             In metres.\n\n| a |\n|---|\n| 1 |\n"
        );
    }
}
