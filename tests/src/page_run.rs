//! A folder in which the commands of a page are run, one after the other, in one shell.

use crate::console::Command;
use crate::program::{self, Finished};
use crate::{answer, page_inputs};
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::process::Stdio;
use tempfile::TempDir;

/// A shell is given this long to begin what takes longer.
const GLANCE: &str = "timeout --preserve-status --signal INT 3";

/// How far a command is run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Depth {
    /// To its end; its exit code and its answer must be as the page says.
    Whole,
    /// Begun, without recordings, and interrupted after a moment: its arguments must be right.
    Begun,
}

/// What a reader of the page has before the first command.
#[derive(Debug)]
pub struct PageFolder {
    folder: TempDir,
    bin: TempDir,
    datasets: Option<PathBuf>,
}

impl PageFolder {
    /// The files of [`page_inputs`], `ddl`, `tracker` and `cameras` on the search path, `target/release/ddl`, and the checkout's `crates`.
    pub fn new(checkout: &Path, datasets: Option<PathBuf>) -> Self {
        let folder = tempfile::tempdir().expect("a temporary folder can be made");
        let bin = tempfile::tempdir().expect("a temporary folder can be made");
        let here = folder.path();
        page_inputs::write(here);
        let link = |from: &Path, to: PathBuf| {
            std::os::unix::fs::symlink(from, to).expect("a link can be made");
        };
        std::fs::create_dir_all(here.join("target/release")).expect("a folder can be made");
        link(program::path(), here.join("target/release/ddl"));
        link(program::path(), bin.path().join("ddl"));
        link(&checkout.join("crates"), here.join("crates"));
        write_program(&bin.path().join("tracker"), &page_inputs::tracker());
        write_program(&bin.path().join("cameras"), &page_inputs::cameras());
        Self {
            folder,
            bin,
            datasets,
        }
    }

    /// Where the commands run.
    pub fn path(&self) -> &Path {
        self.folder.path()
    }

    /// Runs commands in one shell; what is wrong is returned, a text for each command.
    pub fn run(&self, commands: &[(&Command, Depth)]) -> Vec<String> {
        let notes = tempfile::tempdir().expect("a temporary folder can be made");
        let empty = tempfile::tempdir().expect("a temporary folder can be made");
        let mut script = String::new();
        for (i, (command, depth)) in commands.iter().enumerate() {
            let typed = match depth {
                Depth::Whole => command.typed.clone(),
                Depth::Begun => {
                    // What times a program may not be there.
                    let typed = command.typed.trim_start_matches("/usr/bin/time ");
                    let folder = empty.path().display();
                    format!("(cd {folder}; unset DDL_DATASETS; {GLANCE} {typed}\n)")
                }
            };
            let at = notes.path().join(i.to_string());
            let at = at.display();
            // a `String` takes everything
            let _ = writeln!(
                script,
                "{{ {typed}\n}} > {at}.out 2> {at}.err < /dev/null\necho $? > {at}.code"
            );
        }
        let mut shell = std::process::Command::new("bash");
        let search = std::env::var("PATH").unwrap_or_default();
        shell
            .args(["-c", &script])
            .current_dir(self.path())
            .env("PATH", format!("{}:{search}", self.bin.path().display()))
            .env("OMP_NUM_THREADS", "1")
            .env_remove("DDL_DATASETS")
            .env_remove("DDL_COMMIT")
            .stdin(Stdio::null());
        if let Some(datasets) = &self.datasets {
            shell.env("DDL_DATASETS", datasets);
        }
        let output = shell.output().expect("the commands of a page need bash");
        let said = String::from_utf8_lossy(&output.stderr);
        let judged = commands
            .iter()
            .enumerate()
            .filter_map(|(i, (command, depth))| {
                let Some(answered) = read(command, &notes.path().join(i.to_string())) else {
                    return Some(format!(
                        "line {}: `{}` was not run: {said}",
                        command.line, command.typed
                    ));
                };
                let problem = problem(&answered, command, *depth)?;
                Some(format!(
                    "line {}: `{}`: {problem}\n{answered:#?}",
                    command.line, command.typed
                ))
            });
        judged.collect()
    }
}

/// A program that prints these lines.
fn write_program(program: &Path, lines: &str) {
    use std::os::unix::fs::PermissionsExt as _;
    let text = format!("#!/bin/sh\ncat <<'END'\n{lines}END\n");
    std::fs::write(program, text).expect("a program can be written");
    let mode = std::fs::Permissions::from_mode(0o755);
    std::fs::set_permissions(program, mode).expect("a program can be made executable");
}

/// What one command did.
fn read(command: &Command, at: &Path) -> Option<Finished> {
    let bytes = |kind: &str| std::fs::read(at.with_extension(kind)).ok();
    let text = |kind: &str| Some(String::from_utf8_lossy(&bytes(kind)?).into_owned());
    Some(Finished {
        command: command.typed.clone(),
        code: Some(text("code")?.trim().parse().ok()?),
        stdout: text("out")?,
        stderr: text("err")?,
    })
}

fn problem(finished: &Finished, command: &Command, depth: Depth) -> Option<String> {
    let code = finished.code?;
    if depth == Depth::Begun {
        // No recordings, no such run: 1. Interrupted: 130. Wrong arguments: 2.
        let begun = [0, 1, 130].contains(&code);
        return (!begun).then(|| format!("it cannot be begun: exit code {code}"));
    }
    let expected = expected_code(&command.answered);
    if code != expected {
        return Some(format!("exit code {code}, not {expected}"));
    }
    let (stdout, stderr) = (&finished.stdout, &finished.stderr);
    let answers = [format!("{stdout}{stderr}"), format!("{stderr}{stdout}")];
    let missing = answers
        .each_ref()
        .map(|text| answer::first_missing(&command.answered, text));
    let [Some(missing), Some(_)] = missing else {
        return None;
    };
    Some(format!("its answer has no line `{missing}`, or not there"))
}

/// A shown error stands for the exit code 1; one of the arguments, which ends with the advice to ask for help, for 2.
fn expected_code(answered: &[String]) -> i32 {
    let says = |start: &str| answered.iter().any(|line| line.starts_with(start));
    match (says("error: "), says("For more information, try '--help'.")) {
        (true, true) => 2,
        (true, false) => 1,
        (false, _) => 0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn judged(shown: &[&str], (code, stdout, stderr): (i32, &str, &str), depth: Depth) -> String {
        let command = Command {
            line: 1,
            typed: "x".to_owned(),
            answered: shown.iter().map(|&line| line.to_owned()).collect(),
        };
        let finished = Finished {
            command: "x".to_owned(),
            code: Some(code),
            stdout: stdout.to_owned(),
            stderr: stderr.to_owned(),
        };
        problem(&finished, &command, depth).unwrap_or_default()
    }

    #[test]
    fn a_page_that_says_something_else_is_caught() {
        let refused = ["error: e", "For more information, try '--help'."];
        for (shown, code, stdout, stderr, wrong) in [
            (&["a", "note: ..."][..], 0, "a\nb\n", "note: c\n", ""),
            (&["warning: c", "a"], 0, "a\n", "warning: c\n", ""),
            (&["error: e"], 1, "", "error: e\n", ""),
            (&refused, 2, "", &refused.join("\n\n"), ""),
            (&[], 1, "", "error: e\n", "exit code 1, not 0"),
            (&["error: e"], 0, "", "", "exit code 0, not 1"),
            (&["b"], 0, "a\n", "", "no line `b`"),
            (&["c", "a"], 0, "a\nb\nc\n", "", "no line `a`"),
            (&["a...b...c"], 0, "a1b2c3\n", "", "no line `a...b...c`"),
            (&["a...b...c"], 0, "a1b2b3c\n", "", ""),
        ] {
            let problem = judged(shown, (code, stdout, stderr), Depth::Whole);
            assert_eq!(problem.is_empty(), wrong.is_empty(), "{shown:?}");
            assert!(problem.contains(wrong), "{shown:?}: {problem}");
        }
        // What is only begun must have right arguments.
        for (code, right) in [(0, true), (1, true), (130, true), (2, false), (101, false)] {
            let problem = judged(&["y"], (code, "", ""), Depth::Begun);
            assert_eq!(problem.is_empty(), right, "{problem}");
        }
    }
}
