//! A document as the body of an HTML page.

use crate::document::parts::{Document, Part};
use crate::document::table::Table;
use maud::{Markup, PreEscaped, html};

#[derive(Debug)]
pub(crate) struct ContentsEntry {
    pub(crate) id: String,
    pub(crate) heading: Markup,
    /// Class `warned` if the section holds a warning.
    pub(crate) class: Option<&'static str>,
}

impl Document {
    /// The parts without title and lead, and the list of sections. Each section has an `id` made from its heading.
    pub(crate) fn sections(&self) -> (Markup, Vec<ContentsEntry>) {
        let mut contents: Vec<ContentsEntry> = Vec::new();
        let mut used: Vec<String> = Vec::new();
        let mut body = String::new();
        for chunk in self.parts.chunk_by(|_, next| !matches!(next, Part::Heading(_))) {
            let markup = match chunk {
                [Part::Heading(text), parts @ ..] => {
                    let (id, heading) = (unused(identifier(text), &mut used), inline(text));
                    let warned = parts.iter().any(|part| matches!(part, Part::Warning(_)));
                    let class = warned.then_some("warned");
                    let section = html! {
                        section id=(id) class=[class] { h2 { (heading) } (all(parts, &mut used)) }
                    };
                    contents.push(ContentsEntry { id, heading, class });
                    section
                }
                parts => all(parts, &mut used),
            };
            body.push_str(&markup.into_string());
        }
        (PreEscaped(body), contents)
    }
}

fn all(parts: &[Part], used: &mut Vec<String>) -> Markup {
    html! { @for part in parts { (rendered(part, used)) "\n" } }
}

fn rendered(part: &Part, used: &mut Vec<String>) -> Markup {
    match part {
        Part::Heading(text) => html! { h2 id=(unused(identifier(text), used)) { (inline(text)) } },
        Part::Subheading(text) => html! { h3 id=(unused(identifier(text), used)) { (inline(text)) } },
        Part::Paragraph(text) => html! { p { (inline(text)) } },
        Part::Warning(text) => warning(text),
        Part::List(items) => html! { ul { @for item in items { li { (inline(item)) } } } },
        Part::Table(table) => of_table(table),
        Part::Details { summary, parts } => html! {
            details { summary { (inline(summary)) } "\n" (all(parts, used)) }
        },
    }
}

pub(crate) fn warning(text: &str) -> Markup {
    html! { p.warning role="note" { strong { "Warning." } " " (inline(text)) } }
}

/// The table in a box that scrolls and that the keyboard can reach.
fn of_table(table: &Table) -> Markup {
    let class = |column| table.is_text(column).then_some("text");
    html! {
        div.table tabindex="0" {
            table {
                @if let Some(caption) = &table.caption { caption { (inline(caption)) } }
                thead {
                    tr {
                        @for (column, cell) in table.header.iter().enumerate() {
                            th scope="col" class=[class(column)] { (inline(cell)) }
                        }
                    }
                }
                tbody {
                    @for row in &table.rows {
                        tr {
                            @for (column, cell) in row.iter().enumerate() {
                                @if column == 0 {
                                    th.text scope="row" { (inline(cell)) }
                                } @else {
                                    td class=[class(column)] { (inline(cell)) }
                                }
                            }
                        }
                        "\n"
                    }
                }
            }
        }
    }
}

/// Text whose words between backticks are code.
pub(crate) fn inline(text: &str) -> Markup {
    let code = text.split_once('`').and_then(|(before, rest)| Some((before, rest.split_once('`')?)));
    html! {
        @match code {
            Some((before, (code, after))) => { (before) code { (code) } (inline(after)) }
            None => (text),
        }
    }
}

fn identifier(words: &str) -> String {
    let words = words.split(|c: char| !c.is_ascii_alphanumeric()).filter(|word| !word.is_empty());
    words.collect::<Vec<_>>().join("-").to_ascii_lowercase()
}

fn unused(name: String, used: &mut Vec<String>) -> String {
    let before = used.iter().filter(|earlier| **earlier == name).count();
    used.push(name.clone());
    match before {
        0 => name,
        _ => format!("{name}-{}", before + 1),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_is_escaped_code_is_marked_and_the_first_column_heads_its_row() {
        let mut table = Table::new(["method", "eth", "source"]).text_column("source");
        table.row(["A|B", "1", "x"]);
        let document = Document {
            lead: String::new(),
            title: String::new(),
            parts: vec![
                Part::heading("One: `x`"),
                Part::Paragraph("\"a\" < b & `c < d`".to_owned()),
                Part::heading("One x"),
                Part::Warning("<script>".to_owned()),
                Part::Table(table.captioned("In metres.")),
            ],
        };
        let (html, contents) = document.sections();
        for expected in [
            "&quot;a&quot; &lt; b &amp; <code>c &lt; d</code>",
            "<section id=\"one-x\"><h2>One: <code>x</code></h2>",
            "<section id=\"one-x-2\" class=\"warned\">",
            "&lt;script&gt;",
            "<caption>In metres.</caption>",
            "<th scope=\"col\">eth</th><th scope=\"col\" class=\"text\">source</th>",
            "<tr><th class=\"text\" scope=\"row\">A|B</th><td>1</td><td class=\"text\">x</td></tr>",
        ] {
            assert!(html.0.contains(expected), "{expected} in {}", html.0);
        }
        assert_eq!(contents[0].heading.0, "One: <code>x</code>");
        assert_eq!(contents[1].id, "one-x-2");
        assert_eq!([contents[0].class, contents[1].class], [None, Some("warned")]);
    }
}
