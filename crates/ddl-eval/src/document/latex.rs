//! The tables of a document for a paper.

use super::{Document, Part, Span, Table, spans, unfolded};

pub(super) fn tables(document: &Document) -> String {
    let mut text = format!(
        "% {}\n% {}\n% Needs \\usepackage{{booktabs}}.\n",
        one_line(&document.title),
        one_line(&document.lead)
    );
    let mut headings: Vec<&str> = Vec::new();
    let mut warning = None;
    for part in unfolded(&document.parts) {
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
                let caption = match table.caption() {
                    Some(caption) => caption.to_owned(),
                    None => format!("{}.", headings.join(": ")),
                };
                let comment = one_line(&headings.join(": "));
                let float = float(table, &caption, warning);
                text.extend(["\n% ", &comment, "\n", &float]);
            }
            Part::Paragraph(_) | Part::List(_) | Part::Details { .. } => {}
        }
    }
    text
}

fn float(table: &Table, caption: &str, warning: Option<&str>) -> String {
    let columns: String = (0..table.header().len())
        .map(|column| if table.is_text(column) { 'l' } else { 'r' })
        .collect();
    let line = |cells: &[String]| {
        let cells: Vec<String> = cells.iter().map(|cell| inline(cell)).collect();
        format!("    {} \\\\\n", cells.join(" & "))
    };
    let warning = warning.map_or(String::new(), |words| {
        format!(" \\textbf{{Warning.}} {}", inline(words))
    });
    format!(
        "\\begin{{table*}}\n  \\centering\n  \\caption{{{}{warning}}}\n  \\begin{{tabular}}{{{columns}}}\n    \
         \\toprule\n{}    \\midrule\n{}    \\bottomrule\n  \\end{{tabular}}\n\\end{{table*}}\n",
        inline(caption),
        line(table.header()),
        table.rows().iter().map(|row| line(row)).collect::<String>(),
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

/// A comment must not end before its text does.
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
                Part::heading("Protocol `fair`"),
                Part::Table(table),
            ],
        };
        let text = tables(&document);
        let (first, second) = text.split_once("% Protocol `fair`").unwrap();
        assert!(first.contains(
            "\\caption{In metres, \\texttt{star}. \\textbf{Warning.} The TRUE end is used.}"
        ));
        assert!(first.contains("\\begin{tabular}{lr}"));
        assert!(first.contains("    forecaster & a\\_b \\% \\\\\n"));
        assert!(first.contains("    DDL \\& co & 0.1$\\pm$0.2 \\\\\n"));
        assert!(
            second.contains("\\caption{Protocol \\texttt{fair}.}") && !second.contains("Warning")
        );
    }
}
