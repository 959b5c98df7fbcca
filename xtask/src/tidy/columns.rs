//! Columns of Markdown, Rust and Python.

use std::path::Path;

/// Largest number of columns; two files of this width fit side by side on a screen.
const COLUMNS: usize = 120;
/// Blocks whose lines are printed by a program.
const PRINTED: [&str; 3] = ["console", "text", "json"];

/// The lines that are too long.
pub(super) fn faults(file: &Path, text: &str) -> Vec<String> {
    let extension = file.extension().and_then(|extension| extension.to_str());
    let long: Vec<usize> = match extension {
        Some("rs") => numbered(text.lines(), |line| {
            let is_table = |mark| line.trim_start().starts_with(mark);
            line.chars().count() > COLUMNS && !is_table("//! |") && !is_table("/// |")
        }),
        Some("py" | "pyi") => numbered(text.lines(), |line| line.chars().count() > COLUMNS),
        Some("md") => in_markdown(text),
        _ => Vec::new(),
    };
    let fault = |number| format!("{}:{number}: the line has more than {COLUMNS} columns", file.display());
    long.into_iter().map(fault).collect()
}

fn numbered<'a>(lines: impl Iterator<Item = &'a str>, mut is_long: impl FnMut(&str) -> bool) -> Vec<usize> {
    let long = (1..).zip(lines).filter(|(_, line)| is_long(line));
    long.map(|(number, _)| number).collect()
}

/// Rows of tables, printed output and link targets may be longer.
fn in_markdown(text: &str) -> Vec<usize> {
    let (mut is_inside, mut is_printed) = (false, false);
    numbered(text.lines(), |line| {
        let line = line.trim_end();
        if let Some(kind) = line.trim_start().strip_prefix("```") {
            is_inside = !is_inside;
            is_printed = is_inside && PRINTED.contains(&kind.trim());
            return false;
        }
        let is_row = line.trim_start().starts_with('|');
        !is_printed && !is_row && without_targets(line) > COLUMNS
    })
}

/// Characters of a line without the targets of its links.
fn without_targets(line: &str) -> usize {
    let mut parts = line.split("](");
    let first = parts.next().unwrap_or_default().chars().count();
    let rest = parts.map(|part| {
        let after = part.split_once(')').map_or(0, |(_, after)| after.chars().count() + 1);
        2 + after
    });
    first + rest.sum::<usize>()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_lines_are_named_but_for_tables_printed_blocks_and_targets_of_links() {
        let long = "word ".repeat(30);
        let target = "x".repeat(120);
        for (file, text, lines) in [
            ("a.rs", format!("{long}\nshort\n{long}\n"), vec![1, 3]),
            ("a.md", format!("{long}\n"), vec![1]),
            ("a.md", format!("| {long} |\n"), vec![]),
            ("a.md", format!("```console\n{long}\n```\n{long}\n"), vec![4]),
            ("a.md", format!("```rust\n{long}\n```\n"), vec![2]),
            ("a.md", format!("see [this]({target}) page\n"), vec![]),
            ("a.md", format!("see [this]({target}) {long}\n"), vec![1]),
            (
                "a.rs",
                format!("//! | {long} |\n    /// | {long} |\n// | {long} |\n"),
                vec![3],
            ),
            ("a.py", format!("{long}\n"), vec![1]),
            ("a.toml", format!("{long}\n"), vec![]),
            ("a.rs", format!("// {}\n", "é".repeat(117)), vec![]),
        ] {
            let found = faults(Path::new(file), &text);
            let expected: Vec<String> = lines
                .iter()
                .map(|line| format!("{file}:{line}: the line has more than 120 columns"))
                .collect();
            assert_eq!(found, expected, "{text}");
        }
    }
}
