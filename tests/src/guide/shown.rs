//! Comparison of the output that a page shows with the real output.

use crate::console::ConsoleCommand;

/// A shown error implies exit code 1; an error about arguments, which ends with a hint to `--help`, implies 2.
pub(super) fn exit_code(command: &ConsoleCommand) -> &'static str {
    let says = |start: &str| command.answered.iter().any(|line| line.starts_with(start));
    match (says("error: "), says("For more information, try '--help'.")) {
        (true, true) => "2",
        (true, false) => "1",
        (false, _) => "0",
    }
}

/// The lines to show instead of the shown ones; `None` if these agree with the output, or none are shown. As many lines
/// as before the first and after the last line `...` are shown again.
pub(super) fn replacement<'a>(command: &ConsoleCommand, output: &'a str) -> Option<Vec<&'a str>> {
    let is_text = |line: &&str| !line.is_empty();
    let shown: Vec<&str> = command.answered.iter().map(|line| line.trim()).collect();
    let some: Vec<&str> = shown.iter().copied().filter(is_text).collect();
    let real: Vec<&str> = output.lines().map(str::trim).filter(is_text).collect();
    if some.is_empty() || agree(&some, &real) {
        return None;
    }
    let lines: Vec<&str> = output.lines().collect();
    let Some(first) = shown.iter().position(|&line| line == "...") else {
        return Some(lines);
    };
    let after = shown.iter().rev().position(|&line| line == "...").unwrap_or(0);
    if first + after >= lines.len() {
        return Some(lines);
    }
    Some([&lines[..first], &["..."], &lines[lines.len() - after..]].concat())
}

/// The page with other lines below a command.
pub(super) fn replaced(page: &str, command: &ConsoleCommand, lines: &[&str]) -> String {
    let mut page: Vec<&str> = page.lines().collect();
    // A command takes as many lines as its typed text.
    let start = command.line - 1 + command.typed.lines().count();
    page.splice(start..start + command.answered.len(), lines.iter().copied());
    page.join("\n") + "\n"
}

fn agree(shown: &[&str], real: &[&str]) -> bool {
    match shown {
        [] => real.is_empty(),
        ["...", shown @ ..] => (0..=real.len()).any(|left_out| agree(shown, &real[left_out..])),
        [line, shown @ ..] => {
            real.split_first().is_some_and(|(real_line, real)| line_agrees(line, real_line) && agree(shown, real))
        }
    }
}

/// Whether two lines agree: their words are equal, and numbers with a decimal point differ by at most one unit of the
/// last shown digit, or 1e-5. The tolerance is needed because processors with other vector instructions round
/// differently.
fn line_agrees(shown: &str, real: &str) -> bool {
    let is_number = |byte: &u8| byte.is_ascii_digit() || *byte == b'.';
    let parts = |line: &str| -> Vec<String> {
        let parts = line.as_bytes().chunk_by(|a, b| is_number(a) == is_number(b));
        parts.map(|part| String::from_utf8_lossy(part).into_owned()).collect()
    };
    let (shown, real) = (parts(shown), parts(real));
    shown.len() == real.len() && shown.iter().zip(&real).all(|(a, b)| a == b || numbers_agree(a, b))
}

fn numbers_agree(shown: &str, real: &str) -> bool {
    let decimals = |text: &str| text.split_once('.').map_or(0, |(_, decimals)| decimals.len());
    let places = decimals(shown).max(decimals(real));
    let (Ok(a), Ok(b), 1..=20) = (shown.parse::<f64>(), real.parse::<f64>(), places) else {
        return false;
    };
    (a - b).abs() <= 1.01 * 10_f64.powi(-(places as i32)) + 1e-5
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::console;

    fn shows(lines: &[&str], output: &str) -> bool {
        let page = format!("```console\n$ x\n{}\n```\n", lines.join("\n"));
        replacement(&console::commands(&page)[0], output).is_none()
    }

    #[test]
    fn what_a_page_leaves_out_is_marked_by_a_line_of_dots() {
        for (lines, agrees) in [
            (&["a", "b", "c"][..], true),
            (&["a", "..."], true),
            (&["...", "c"], true),
            (&["a", "...", "c"], true),
            (&["...", "b", "..."], true),
            (&["..."], true),
            (&[], true),
            (&["a", "b"], false),
            (&["b", "c"], false),
            (&["a", "c"], false),
            (&["...", "b"], false),
            (&["a", "...", "d"], false),
            (&["a", "b", "c", "d"], false),
            (&["...", "c", "...", "b", "..."], false),
            (&["a", "b..."], false),
        ] {
            assert_eq!(shows(lines, "a\n\n  b\nc\n"), agrees, "{lines:?}");
        }
    }

    #[test]
    fn the_last_place_of_a_decimal_number_may_differ_and_no_word_or_count() {
        for (line, real, agrees) in [
            ("x 0.123 m", "x 0.124 m", true),
            ("-1.50,2", "-1.49,2", true),
            ("0.9999999", "1.0", true),
            ("x 0.123 m", "x 0.125 m", false),
            ("x 0.123 m", "y 0.123 m", false),
            ("12 of 20", "13 of 20", false),
            ("1.", "2.", false),
            ("-0.5", "0.5", false),
            ("a 1", "a", false),
        ] {
            assert_eq!(shows(&[line], real), agrees, "{line}, {real}");
        }
    }

    #[test]
    fn output_is_replaced_and_what_was_left_out_is_left_out_again() {
        let page = "a\n```console\n$ x\n1\n...\n3\n$ for i in 1; do\n>   echo $i\n> done\n1\n```\nb\n";
        let commands = console::commands(page);
        let with = |page: &str, command: &ConsoleCommand, output: &str| {
            replaced(page, command, &replacement(command, output).unwrap_or_default())
        };
        let last = with(page, &commands[1], "8\n9\n");
        let both = with(&last, &commands[0], "4\n5\n6\n7\n");
        let expected = "a\n```console\n$ x\n4\n...\n7\n$ for i in 1; do\n>   echo $i\n> done\n8\n9\n```\nb\n";
        assert_eq!(both, expected);
    }
}
