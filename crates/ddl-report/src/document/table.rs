//! A table of text and numbers, and its markdown form.

/// A table. The first column is text; the others hold numbers, unless they are marked as text.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Table {
    pub(super) caption: Option<String>,
    pub(super) header: Vec<String>,
    text: Vec<bool>,
    /// Each as long as the header.
    pub(crate) rows: Vec<Vec<String>>,
}

impl Table {
    /// A table with these column names and no rows.
    pub(crate) fn new<S: Into<String>>(header: impl IntoIterator<Item = S>) -> Self {
        let header: Vec<_> = header.into_iter().map(Into::into).collect();
        let text = (0..header.len()).map(|column| column == 0).collect();
        Self { caption: None, header, text, rows: Vec::new() }
    }

    /// A table with columns of text, a column for each fold, and further columns.
    pub(crate) fn of_folds(text: &[&str], folds: &[&str], end: &[&str]) -> Self {
        let table = Self::new([text, folds, end].concat());
        text.iter().fold(table, |table, name| table.text_column(name))
    }

    /// Marks the columns of this name as text.
    #[must_use]
    pub(crate) fn text_column(mut self, name: &str) -> Self {
        for (text, _) in self.text.iter_mut().zip(&self.header).filter(|(_, cell)| *cell == name) {
            *text = true;
        }
        self
    }

    /// Adds a caption, which should name the data convention, the unit and what was averaged.
    #[must_use]
    pub(crate) fn captioned(self, caption: impl Into<String>) -> Self {
        Self { caption: Some(caption.into()), ..self }
    }

    /// Whether a column is text, and not numbers.
    pub(crate) fn is_text(&self, column: usize) -> bool {
        self.text.get(column).copied().unwrap_or(false)
    }

    /// Adds a row. Missing cells are empty, cells beyond the header are dropped.
    pub(crate) fn row<S: Into<String>>(&mut self, cells: impl IntoIterator<Item = S>) -> &mut Self {
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
        let lines = std::iter::once(&self.header).chain(&self.rows);
        let lines: Vec<Vec<String>> = lines.map(|cells| cells.iter().map(|cell| escape(cell)).collect()).collect();
        let longest = |column: usize| lines.iter().map(|cells| cells[column].chars().count()).max();
        let widths: Vec<usize> = if f.alternate() {
            vec![0; self.header.len()]
        } else {
            (0..self.header.len()).filter_map(longest).collect()
        };
        let columns = || widths.iter().zip(&self.text);
        for (number, cells) in lines.iter().enumerate() {
            for (cell, (&width, text)) in cells.iter().zip(columns()) {
                if *text {
                    write!(f, "| {cell:<width$} ")?;
                } else {
                    write!(f, "| {cell:>width$} ")?;
                }
            }
            writeln!(f, "|")?;
            if number == 0 {
                // The line under the header sets the alignment of the columns.
                for (&width, text) in columns() {
                    write!(f, "|{:->length$}", if *text { "-" } else { ":" }, length = width.max(1) + 2)?;
                }
                writeln!(f, "|")?;
            }
        }
        Ok(())
    }
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
            ["| a\\|b | c | d     |", "|------|--:|-------|", "| x y  |   |       |", "| 1    | 2 | three |"]
        );
        assert_eq!(format!("{table:#}"), "| a\\|b | c | d |\n|---|--:|---|\n| x y |  |  |\n| 1 | 2 | three |\n");
    }
}
