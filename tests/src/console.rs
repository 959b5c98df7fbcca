//! Commands on the pages of the documentation. `xtask`, which does not depend on this crate, includes this file.

#![allow(unreachable_pub, reason = "public in one of the two crates that it belongs to")]

/// A command as shown on a page.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ConsoleCommand {
    /// Number of its line on the page, from 1.
    pub line: usize,
    /// The typed text, without the prompt; several lines if it continues after `> `.
    pub typed: String,
    /// The lines below it: the output, with `...` for lines that are left out.
    pub answered: Vec<String>,
}

/// The commands of a page's `console` blocks, in their order.
pub fn commands(page: &str) -> Vec<ConsoleCommand> {
    let mut commands: Vec<ConsoleCommand> = Vec::new();
    let mut inside = false;
    for (line, text) in (1..).zip(page.lines()) {
        let text = text.trim_start();
        if let Some(kind) = text.strip_prefix("```") {
            inside = !inside && kind.trim() == "console";
            continue;
        }
        if !inside {
            continue;
        }
        if let Some(typed) = text.strip_prefix("$ ") {
            commands.push(ConsoleCommand { line, typed: typed.trim_end().to_owned(), answered: Vec::new() });
        } else if let Some(last) = commands.last_mut() {
            match text.strip_prefix("> ") {
                Some(more) if last.answered.is_empty() => {
                    last.typed.push('\n');
                    last.typed.push_str(more.trim_end());
                }
                _ => last.answered.push(text.trim_end().to_owned()),
            }
        }
    }
    commands
}

impl ConsoleCommand {
    /// The words of a plain command, without comment and redirections; `None` if it uses other features of a shell.
    pub fn words(&self) -> Option<Vec<&str>> {
        let typed = self.typed.split(" #").next().unwrap_or_default();
        let is_plain = !typed.contains(['|', ';', '&', '$', '`', '(', '\n', '"', '\'', '<', '>']);
        is_plain.then(|| typed.split_whitespace().collect())
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a test may panic")]

    use super::*;

    #[test]
    fn commands_are_taken_with_their_answers() {
        let page = "text\n```console\n$ ddl info   # what is there\nversion: 1\n...\n$ for i in 1 2; do\n>   echo $i\n\
                    > done\n```\n\
            ```text\n$ not this\n```\n  ```console\n  $ ls -l\n  ```\n";
        let commands = commands(page);
        let typed: Vec<(usize, &str)> = commands.iter().map(|command| (command.line, command.typed.as_str())).collect();
        assert_eq!(typed, [(3, "ddl info   # what is there"), (6, "for i in 1 2; do\n  echo $i\ndone"), (14, "ls -l")]);
        assert_eq!(commands[0].answered, ["version: 1", "..."]);
        assert_eq!(commands[0].words().unwrap(), ["ddl", "info"]);
        assert_eq!(commands[1].words(), None);
        assert_eq!(commands[2].words().unwrap(), ["ls", "-l"]);
    }
}
