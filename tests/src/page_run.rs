//! A folder in which the commands of a page are run, one after the other, in one shell.

use crate::console::Command;
use crate::program::{self, Finished};
use crate::{answer, page_inputs};
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::process::Stdio;
use tempfile::TempDir;

/// Interrupts a command after a few seconds.
const GLANCE: &str = "timeout --preserve-status --signal INT 3";

/// The extent to which a command is run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Depth {
    /// To its end; its exit code and its output must agree with the page.
    Whole,
    /// Started without recordings and interrupted after a moment: its arguments must be valid.
    Begun,
}

/// A fault of a command on a page.
#[derive(Debug)]
pub struct Problem {
    /// Text that describes the fault.
    pub text: String,
    /// The output, if the only fault is that the page shows other output.
    pub answer: Option<String>,
}

/// The folder that a reader of the page has before the first command.
#[derive(Debug)]
pub struct PageFolder {
    folder: TempDir,
    bin: TempDir,
    datasets: Option<PathBuf>,
}

impl PageFolder {
    /// The files of [`page_inputs`], `ddl`, `tracker` and `cameras` on the search path, `target/release/ddl`, and the
    /// checkout's `crates` and `datasets/sample.csv`.
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
        std::fs::create_dir(here.join("datasets")).expect("a folder can be made");
        let sample = "datasets/sample.csv";
        link(&checkout.join(sample), here.join(sample));
        write_program(&bin.path().join("tracker"), &page_inputs::tracker());
        write_program(&bin.path().join("cameras"), &page_inputs::cameras());
        Self { folder, bin, datasets }
    }

    /// The folder in which the commands run.
    pub fn path(&self) -> &Path {
        self.folder.path()
    }

    /// Runs commands in one shell. Returns the faults, each with the index of its command.
    pub fn run(&self, commands: &[(&Command, Depth)]) -> Vec<(usize, Problem)> {
        let notes = tempfile::tempdir().expect("a temporary folder can be made");
        let empty = tempfile::tempdir().expect("a temporary folder can be made");
        let mut script = String::new();
        for (i, (command, depth)) in commands.iter().enumerate() {
            let typed = match depth {
                Depth::Whole => command.typed.clone(),
                Depth::Begun => {
                    // The program `time` may not be installed.
                    let typed = command.typed.trim_start_matches("/usr/bin/time ");
                    let folder = empty.path().display();
                    format!("(cd {folder}; unset DDL_DATASETS; {GLANCE} {typed}\n)")
                }
            };
            let at = notes.path().join(i.to_string());
            let at = at.display();
            // Formatting into a `String` cannot fail.
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
        let judged = commands.iter().enumerate().filter_map(|(i, (command, depth))| {
            let (line, typed) = (command.line, &command.typed);
            let Some(answered) = read(command, &notes.path().join(i.to_string())) else {
                let text = format!("line {line}: `{typed}` was not run: {said}");
                let answer = None;
                return Some((i, Problem { text, answer }));
            };
            let (problem, answer) = problem(&answered, command, *depth)?;
            let text = format!("line {line}: `{typed}`: {problem}\n{answered:#?}");
            Some((i, Problem { text, answer }))
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

/// The result of one command.
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

/// The fault of a command, with the output if the page shows another one.
fn problem(finished: &Finished, command: &Command, depth: Depth) -> Option<(String, Option<String>)> {
    let code = finished.code?;
    if depth == Depth::Begun {
        // No recordings, no such run: 1. Interrupted: 130. Invalid arguments: 2.
        let begun = [0, 1, 130].contains(&code);
        return (!begun).then(|| (format!("it cannot be begun: exit code {code}"), None));
    }
    let expected = expected_code(&command.answered);
    if code != expected {
        return Some((format!("exit code {code}, not {expected}"), None));
    }
    // A command that is shown without output is not compared.
    if command.answered.iter().all(String::is_empty) {
        return None;
    }
    let (stdout, stderr) = (&finished.stdout, &finished.stderr);
    let answer = format!("{stdout}{stderr}");
    let in_one_order = answer::difference(&command.answered, &answer)?;
    let in_the_other = answer::difference(&command.answered, &format!("{stderr}{stdout}"));
    in_the_other.and(Some((in_one_order, Some(answer))))
}

/// A shown error implies exit code 1; an error about arguments, which ends with a hint to `--help`, implies 2.
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
        let problem = problem(&finished, &command, depth);
        problem.map_or_else(String::new, |(text, _)| text)
    }

    #[test]
    fn a_page_that_differs_is_detected() {
        let refused = ["error: e", "For more information, try '--help'."];
        for (shown, code, stdout, stderr, wrong) in [
            (&["a", "...", "note: c"][..], 0, "a\nb\n", "note: c\n", ""),
            (&["warning: c", "a"], 0, "a\n", "warning: c\n", ""),
            (&["error: e"], 1, "", "error: e\n", ""),
            (&refused, 2, "", &refused.join("\n\n"), ""),
            (&[], 0, "a\n", "", ""),
            (&[], 1, "", "error: e\n", "exit code 1, not 0"),
            (&["error: e"], 0, "", "", "exit code 0, not 1"),
            (&["b"], 0, "a\n", "", "the page shows \"b\""),
            (&["a"], 0, "a\nb\n", "", "does not show \"b\""),
        ] {
            let problem = judged(shown, (code, stdout, stderr), Depth::Whole);
            assert_eq!(problem.is_empty(), wrong.is_empty(), "{shown:?}");
            assert!(problem.contains(wrong), "{shown:?}: {problem}");
        }
        // A command that is only started must have valid arguments.
        for (code, right) in [(0, true), (1, true), (130, true), (2, false), (101, false)] {
            let problem = judged(&["y"], (code, "", ""), Depth::Begun);
            assert_eq!(problem.is_empty(), right, "{problem}");
        }
    }
}
