//! The tables of a document for a paper.

use crate::document::parts::{Document, Part, Span, spans, unfolded};
use crate::document::table::Table;

impl Document {
    /// The tables for a paper, each a `table*`, to be included with `\input`; needs `booktabs` and `adjustbox`.
    pub(crate) fn to_latex(&self) -> String {
        let mut text = format!(
            "% {}\n% {}\n% Needs \\usepackage{{booktabs,adjustbox}}.\n",
            one_line(&self.title),
            one_line(&self.lead)
        );
        let mut headings: Vec<&str> = Vec::new();
        let mut warning = None;
        let mut count = 0;
        let mut parts = unfolded(&self.parts).peekable();
        while let Some(part) = parts.next() {
            match part {
                Part::Heading { level, text: words } => {
                    if *level == 1 {
                        warning = None;
                    }
                    headings.truncate(level - 1);
                    headings.push(words);
                }
                Part::Warning(words) => warning = Some(words.as_str()),
                Part::Table(table) => {
                    let caption = match &table.caption {
                        Some(caption) => caption.clone(),
                        None => format!("{}.", headings.join(": ")),
                    };
                    let comment = one_line(&headings.join(": "));
                    // A list right after a table gives the conditions of its lines.
                    let notes = match parts.peek() {
                        Some(Part::List(items)) => items.join(" "),
                        _ => String::new(),
                    };
                    count += 1;
                    let float = float(table, &caption, warning, &notes, count);
                    text.extend(["\n% ", &comment, "\n", &float]);
                }
                Part::Paragraph(_) | Part::List(_) | Part::Details { .. } => {}
            }
        }
        text
    }
}

fn float(table: &Table, caption: &str, warning: Option<&str>, notes: &str, number: usize) -> String {
    let columns: String = (0..table.header.len())
        .map(|column| if table.is_text(column) { 'l' } else { 'r' })
        .collect();
    let line = |cells: &[String]| {
        let cells: Vec<String> = cells.iter().map(|cell| inline(cell)).collect();
        format!("    {} \\\\\n", cells.join(" & "))
    };
    let warning = warning.map_or(String::new(), |words| {
        format!(" \\textbf{{Warning.}} {}", inline(words))
    });
    let notes = if notes.is_empty() {
        String::new()
    } else {
        format!("  \\par\\smallskip\\footnotesize {}\n", inline(notes))
    };
    format!(
        "\\begin{{table*}}\n  \\centering\\small\n  \\caption{{{}{warning}}}\\label{{tab:ddl-{number}}}\n  \
         \\begin{{adjustbox}}{{max width=\\textwidth}}\n  \\begin{{tabular}}{{{columns}}}\n    \
         \\toprule\n{}    \\midrule\n{}    \\bottomrule\n  \\end{{tabular}}\n  \
         \\end{{adjustbox}}\n{notes}\\end{{table*}}\n",
        inline(caption),
        line(&table.header),
        table.rows.iter().map(|row| line(row)).collect::<String>(),
    )
}

fn inline(text: &str) -> String {
    let rendered = spans(text).into_iter().map(|span| match span {
        Span::Plain(text) => escape(text),
        Span::Code(code) => format!("\\texttt{{{}}}", escape(code)),
    });
    rendered.collect()
}

fn escape(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for character in text.chars() {
        match character {
            '&' | '%' | '$' | '#' | '_' | '{' | '}' => {
                escaped.push('\\');
                escaped.push(character);
            }
            '\\' => escaped += "\\textbackslash{}",
            '~' => escaped += "\\textasciitilde{}",
            '^' => escaped += "\\textasciicircum{}",
            '<' => escaped += "$<$",
            '>' => escaped += "$>$",
            '±' => escaped += "$\\pm$",
            '×' => escaped += "$\\times$",
            '\n' | '\r' => escaped.push(' '),
            other => escaped.push(other),
        }
    }
    escaped
}

/// One line, because a line break would end the comment.
fn one_line(text: &str) -> String {
    text.replace(['\n', '\r'], " ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_table_carries_its_caption_and_the_warning_of_its_section() {
        let mut table = Table::new(["forecaster", "a_b %"]);
        table.row(["DDL & co", "0.1±0.2"]);
        let document = Document {
            lead: "Data.".to_owned(),
            title: "Results".to_owned(),
            parts: vec![
                Part::heading("Protocol `published`"),
                Part::Warning("The TRUE end is used.".to_owned()),
                Part::Table(table.clone().captioned("In metres, `star`.")),
                Part::List(vec!["DDL: seed 1.".to_owned(), "Others: none.".to_owned()]),
                Part::heading("Protocol `fair`"),
                Part::Table(table),
            ],
        };
        let text = document.to_latex();
        let (first, second) = text.split_once("% Protocol `fair`").unwrap();
        assert!(first.contains("\\caption{In metres, \\texttt{star}. \\textbf{Warning.} The TRUE end is used.}"));
        assert!(first.contains("\\footnotesize DDL: seed 1. Others: none.\n"));
        assert!(first.contains("\\label{tab:ddl-1}") && second.contains("\\label{tab:ddl-2}"));
        assert!(first.contains("\\begin{tabular}{lr}"));
        assert!(first.contains("    forecaster & a\\_b \\% \\\\\n"));
        assert!(first.contains("    DDL \\& co & 0.1$\\pm$0.2 \\\\\n"));
        assert!(second.contains("\\caption{Protocol \\texttt{fair}.}") && !second.contains("Warning"));
    }
}
