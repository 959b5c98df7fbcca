//! A table of text and numbers, and its markdown form.

use comfy_table::{CellAlignment, presets::ASCII_MARKDOWN};

/// A table. The first column is text; the others hold numbers, unless marked by [`text_column`](Self::text_column).
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Table {
    caption: Option<String>,
    header: Vec<String>,
    text: Vec<bool>,
    rows: Vec<Vec<String>>,
}

impl Table {
    /// A table with these column names and no rows.
    pub fn new<S: Into<String>>(header: impl IntoIterator<Item = S>) -> Self {
        let header: Vec<_> = header.into_iter().map(Into::into).collect();
        let text = (0..header.len()).map(|column| column == 0).collect();
        Self {
            caption: None,
            header,
            text,
            rows: Vec::new(),
        }
    }

    /// Marks the columns of this name as text.
    #[must_use]
    pub fn text_column(mut self, name: &str) -> Self {
        for (text, _) in self.text.iter_mut().zip(&self.header).filter(|(_, cell)| *cell == name) {
            *text = true;
        }
        self
    }

    /// Adds a caption, which should name the data convention, the unit and what was averaged.
    #[must_use]
    pub fn captioned(self, caption: impl Into<String>) -> Self {
        Self {
            caption: Some(caption.into()),
            ..self
        }
    }

    /// The caption, if it has one.
    pub fn caption(&self) -> Option<&str> {
        self.caption.as_deref()
    }

    /// The column names.
    pub fn header(&self) -> &[String] {
        &self.header
    }

    /// The rows, each as long as the header.
    pub fn rows(&self) -> &[Vec<String>] {
        &self.rows
    }

    /// Whether a column is text, and not numbers.
    pub fn is_text(&self, column: usize) -> bool {
        self.text.get(column).copied().unwrap_or(false)
    }

    /// Adds a row. Missing cells are empty, cells beyond the header are dropped.
    pub fn row<S: Into<String>>(&mut self, cells: impl IntoIterator<Item = S>) -> &mut Self {
        let mut row: Vec<_> = cells.into_iter().map(Into::into).collect();
        row.resize(self.header.len(), String::new());
        self.rows.push(row);
        self
    }
}

/// Escapes `|` and line breaks, which would end the column or the row.
fn escape(cell: &str) -> String {
    cell.replace('|', "\\|").replace(['\n', '\r'], " ")
}

/// A Markdown table with padded columns; `{:#}` leaves the padding out.
impl std::fmt::Display for Table {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        if f.alternate() {
            return self.write_unpadded(f);
        }
        let mut table = comfy_table::Table::new();
        table
            .load_style(ASCII_MARKDOWN)
            .set_header(self.header.iter().map(|cell| escape(cell)))
            .add_rows(self.rows.iter().map(|row| row.iter().map(|cell| escape(cell))));
        for (column, text) in table.column_iter_mut().zip(&self.text) {
            let side = if *text {
                CellAlignment::Left
            } else {
                CellAlignment::Right
            };
            column.set_cell_alignment(side);
        }
        for (number, line) in table.lines().enumerate() {
            // The line under the header sets the alignment of the columns.
            let line = if number == 1 {
                align_numbers(&line, &self.text)
            } else {
                line
            };
            writeln!(f, "{line}")?;
        }
        Ok(())
    }
}

impl Table {
    fn write_unpadded(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let line = |cells: &[String]| {
            let cells = cells.iter().map(|cell| format!(" {} |", escape(cell)));
            format!("|{}", cells.collect::<String>())
        };
        let rule = self.text.iter().map(|&text| if text { "---|" } else { "--:|" });
        writeln!(f, "{}", line(&self.header))?;
        writeln!(f, "|{}", rule.collect::<String>())?;
        for row in &self.rows {
            writeln!(f, "{}", line(row))?;
        }
        Ok(())
    }
}

fn align_numbers(rule: &str, text: &[bool]) -> String {
    let columns = rule.trim_matches('|').split('|').zip(text);
    columns.fold("|".to_owned(), |rule, (dashes, text)| match dashes.strip_suffix('-') {
        Some(shorter) if !text => rule + shorter + ":|",
        _ => rule + dashes + "|",
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bars_and_line_ends_stay_inside_their_cell() {
        let mut table = Table::new(["a|b", "c", "d"]).text_column("d");
        table.row(["x\ny"]).row(["1", "2", "three", "4"]);
        let lines: Vec<String> = table.to_string().lines().map(str::to_owned).collect();
        assert_eq!(
            lines,
            [
                "| a\\|b | c | d     |",
                "|------|--:|-------|",
                "| x y  |   |       |",
                "| 1    | 2 | three |"
            ]
        );
        assert_eq!(
            format!("{table:#}"),
            "| a\\|b | c | d |\n|---|--:|---|\n| x y |  |  |\n| 1 | 2 | three |\n"
        );
    }
}
