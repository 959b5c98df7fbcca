//! Writes the output of commands into their page.

use crate::console::Command;

/// The page with the answers of some commands replaced, in the order of the page. As many lines as were shown before
/// the first and after the last line `...` are shown again.
pub(super) fn replaced<'a>(page: &str, answers: impl Iterator<Item = (&'a Command, &'a str)>) -> String {
    let mut lines: Vec<&str> = page.lines().collect();
    let answers: Vec<_> = answers.collect();
    for (command, answer) in answers.into_iter().rev() {
        // A command takes as many lines as its typed text.
        let start = command.line - 1 + command.typed.lines().count();
        let shown = &command.answered;
        let answer: Vec<&str> = answer.lines().collect();
        let is_left_out = |line: &String| line == "...";
        let (before, after) = match shown.iter().position(is_left_out) {
            Some(first) => (first, shown.iter().rev().position(is_left_out).unwrap_or(0)),
            None => (answer.len(), 0),
        };
        let whole = before + after >= answer.len();
        let new: Vec<&str> = if whole {
            answer
        } else {
            let tail = answer.len() - after;
            [&answer[..before], &["..."], &answer[tail..]].concat()
        };
        lines.splice(start..start + shown.len(), new);
    }
    lines.join("\n") + "\n"
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::console;

    #[test]
    fn answers_are_replaced_and_what_was_left_out_is_left_out_again() {
        let page = "a\n```console\n$ x\n1\n...\n3\n$ for i in 1; do\n>   echo $i\n> done\n1\n```\nb\n";
        let commands = console::commands(page);
        let answers = commands.iter().zip(["4\n5\n6\n7\n", "8\n9\n"]);
        assert_eq!(
            replaced(page, answers),
            "a\n```console\n$ x\n4\n...\n7\n$ for i in 1; do\n>   echo $i\n> done\n8\n9\n```\nb\n"
        );
    }
}
