//! A document as the body of an HTML page.

use super::parts::{Document, Part, Span, spans};
use super::table::Table;

#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct ContentsEntry {
    pub(crate) id: String,
    pub(crate) heading: String,
    pub(crate) warned: bool,
}

impl Document {
    /// HTML for the body of a page: lead, title and parts. Each section has an `id` made from its heading; text is
    /// escaped.
    pub fn to_html(&self) -> String {
        format!(
            "<header>\n<h1>{}</h1>\n<p class=\"lead\">{}</p>\n</header>\n{}",
            inline(&self.title),
            inline(&self.lead),
            self.sections().0
        )
    }

    /// The parts as HTML, without title and lead, and the list of sections; those with a warning have the class
    /// `warned`.
    pub(crate) fn sections(&self) -> (String, Vec<ContentsEntry>) {
        let mut body = String::new();
        let mut contents: Vec<ContentsEntry> = Vec::new();
        let mut used: Vec<String> = Vec::new();
        for (at, part) in self.parts.iter().enumerate() {
            let rendered = match part {
                Part::Heading { level: 1, text } => {
                    let end = if contents.is_empty() { "" } else { "</section>\n" };
                    let (id, heading) = (unused(identifier(text), &mut used), inline(text));
                    let warned = warns(&self.parts[at + 1..]);
                    let class = if warned { " class=\"warned\"" } else { "" };
                    let section = format!("{end}<section id=\"{id}\"{class}>\n<h2>{heading}</h2>\n");
                    contents.push(ContentsEntry { id, heading, warned });
                    section
                }
                Part::Details { summary, parts } => {
                    let parts: Vec<String> = parts.iter().map(|part| plain(part, &mut used)).collect();
                    format!(
                        "<details>\n<summary>{}</summary>\n{}</details>\n",
                        inline(summary),
                        parts.concat()
                    )
                }
                other => plain(other, &mut used),
            };
            body.push_str(&rendered);
        }
        if !contents.is_empty() {
            body.push_str("</section>\n");
        }
        (body, contents)
    }
}

fn plain(part: &Part, used: &mut Vec<String>) -> String {
    match part {
        Part::Heading { level, text } => {
            let level = (level + 1).min(6);
            let id = unused(identifier(text), used);
            format!("<h{level} id=\"{id}\">{}</h{level}>\n", inline(text))
        }
        Part::Paragraph(text) => format!("<p>{}</p>\n", inline(text)),
        Part::Warning(text) => format!(
            "<p class=\"warning\" role=\"note\"><strong>Warning.</strong> {}</p>\n",
            inline(text)
        ),
        Part::List(items) => {
            let items: Vec<String> = items.iter().map(|item| inline(item)).collect();
            format!("<ul>\n<li>{}</li>\n</ul>\n", items.join("</li>\n<li>"))
        }
        Part::Table(table) => render(table),
        // Details do not nest.
        Part::Details { .. } => String::new(),
    }
}

fn warns(parts: &[Part]) -> bool {
    parts
        .iter()
        .take_while(|part| !matches!(part, Part::Heading { level: 1, .. }))
        .any(|part| matches!(part, Part::Warning(_)))
}

/// The table in a box that scrolls and that the keyboard can reach.
fn render(table: &Table) -> String {
    let caption = table.caption().map_or(String::new(), |caption| {
        format!("<caption>{}</caption>\n", inline(caption))
    });
    let class = |column: usize| {
        if table.is_text(column) { " class=\"text\"" } else { "" }
    };
    let header: Vec<String> = table
        .header()
        .iter()
        .enumerate()
        .map(|(column, cell)| format!("<th scope=\"col\"{}>{}</th>", class(column), inline(cell)))
        .collect();
    let row = |row: &Vec<String>| {
        let cells: Vec<String> = row
            .iter()
            .enumerate()
            .map(|(column, cell)| match (column, inline(cell)) {
                (0, cell) => format!("<th scope=\"row\" class=\"text\">{cell}</th>"),
                (_, cell) => format!("<td{}>{cell}</td>", class(column)),
            })
            .collect();
        ["<tr>", &cells.concat(), "</tr>\n"].concat()
    };
    format!(
        "<div class=\"table\" tabindex=\"0\">\n<table>\n{caption}<thead><tr>{}</tr></thead>\n\
         <tbody>\n{}</tbody>\n</table>\n</div>\n",
        header.concat(),
        table.rows().iter().map(row).collect::<String>()
    )
}

pub(crate) fn inline(text: &str) -> String {
    let rendered = spans(text).into_iter().map(|span| match span {
        Span::Plain(text) => escape(text),
        Span::Code(code) => format!("<code>{}</code>", escape(code)),
    });
    rendered.collect()
}

/// Text with escaped markup characters, also for attributes.
pub(crate) fn escape(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for character in text.chars() {
        match character {
            '&' => escaped += "&amp;",
            '<' => escaped += "&lt;",
            '>' => escaped += "&gt;",
            '"' => escaped += "&quot;",
            '\'' => escaped += "&#39;",
            other => escaped.push(other),
        }
    }
    escaped
}

pub(crate) fn identifier(words: &str) -> String {
    let words = words
        .split(|c: char| !c.is_ascii_alphanumeric())
        .filter(|word| !word.is_empty());
    words.collect::<Vec<_>>().join("-").to_ascii_lowercase()
}

pub(crate) fn unused(name: String, used: &mut Vec<String>) -> String {
    let before = used.iter().filter(|known| **known == name).count();
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
            lead: "a < b & `c < d`".to_owned(),
            title: "\"T\"".to_owned(),
            parts: vec![
                Part::heading("One: `x`"),
                Part::heading("One x"),
                Part::Warning("<script>".to_owned()),
                Part::Table(table.captioned("In metres.")),
            ],
        };
        let html = document.to_html();
        for expected in [
            "<h1>&quot;T&quot;</h1>",
            "a &lt; b &amp; <code>c &lt; d</code>",
            "<section id=\"one-x\">\n<h2>One: <code>x</code></h2>\n</section>",
            "<section id=\"one-x-2\" class=\"warned\">",
            "&lt;script&gt;",
            "<caption>In metres.</caption>",
            "<th scope=\"col\">eth</th><th scope=\"col\" class=\"text\">source</th>",
            "<tr><th scope=\"row\" class=\"text\">A|B</th><td>1</td><td class=\"text\">x</td></tr>",
        ] {
            assert!(html.contains(expected), "{expected}");
        }
        let (_, contents) = document.sections();
        assert_eq!(contents[0].heading, "One: <code>x</code>");
        assert_eq!(contents[1].id, "one-x-2");
        let warned: Vec<bool> = contents.iter().map(|entry| entry.warned).collect();
        assert_eq!(warned, [false, true]);
    }
}
