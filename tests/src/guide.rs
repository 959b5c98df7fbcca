//! Runs the commands that the documentation shows, and compares their output with the page. A shown line `...` stands
//! for lines that are left out. With the variable `DDL_WRITE_SHOWN`, output on a page that differs is replaced.
//!
//! A test of xtask checks the arguments of `cargo xtask` (`xtask/src/command/docs.rs`).

#![allow(clippy::unwrap_used, reason = "a test may panic")]

mod shown;

use crate::console::{self, ConsoleCommand};
use crate::{drawn_model, folder_contents, own_tracks, program, recordings};
use ddl::Variant;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

/// Commands that take minutes or need recordings of other places, as lines `PAGE: BEGINNING`; they are only begun.
pub const LONG: &str = include_str!("../guide/long.txt");

/// Commands that need another machine or another tool, as lines `PAGE: BEGINNING`.
pub const ELSEWHERE: &str = include_str!("../guide/elsewhere.txt");

/// Interrupts a command after a few seconds.
const BEGIN: &str = "timeout --preserve-status --signal INT 3 bash";

/// Whether a command has this page and beginning.
pub fn begins(page: &str, command: &ConsoleCommand, entry: &str) -> bool {
    let (entry_page, start) = entry.split_once(':').unwrap();
    page == entry_page && command.typed.starts_with(start.trim_start())
}

/// The folder of the workspace.
pub fn checkout() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap().to_path_buf()
}

/// The commands of a page, given by its path in the workspace.
pub fn commands(page: &str) -> Vec<ConsoleCommand> {
    console::commands(&text_of(page))
}

fn text_of(page: &str) -> String {
    std::fs::read_to_string(checkout().join(page)).unwrap_or_else(|error| panic!("{page}: {error}"))
}

/// Runs the commands of a page in one shell, and compares their outputs with the page.
pub fn check(page: &str) {
    let text = text_of(page);
    let is_on = |list: &str, command: &ConsoleCommand| list.lines().any(|entry| begins(page, command, entry));
    let datasets = recordings::star_folder();
    let mut commands = console::commands(&text);
    for command in &mut commands {
        // The program is built already.
        if let Some(arguments) = command.typed.strip_prefix("cargo run --release -p ddl-cli -- ") {
            command.typed = format!("ddl {arguments}");
        }
    }
    commands.retain(|command| {
        let of_cargo = command.typed.starts_with("cargo ");
        if of_cargo && !command.typed.starts_with("cargo xtask ") {
            check_cargo(page, command);
        }
        !of_cargo && !is_on(ELSEWHERE, command)
    });
    let is_begun = |command: &ConsoleCommand| {
        let of_recordings = command.typed.contains("--fold ") && !command.typed.contains("--convention simulated");
        is_on(LONG, command) || of_recordings && datasets.is_none()
    };
    let folder = tempfile::tempdir().unwrap();
    prepare(&text, folder.path());
    let notes = tempfile::tempdir().unwrap();
    let script = script(&commands, is_begun, notes.path());
    let mut shell = program::undisturbed(Path::new("bash"), folder.path(), "");
    shell.args(["-c", &script]);
    let search = std::env::var("PATH").unwrap_or_default();
    shell.env("PATH", format!("{}/target/release:{search}", folder.path().display()));
    shell.envs(datasets.as_ref().map(|datasets| ("DDL_DATASETS", datasets)));
    let shell = shell.output().unwrap();

    let (mut faults, mut new_text) = (Vec::new(), text.clone());
    for (i, command) in commands.iter().enumerate().rev() {
        let note = |kind: &str| std::fs::read_to_string(notes.path().join(format!("{i}.{kind}")));
        let (output, code) = (note("output").unwrap_or_default(), note("code").unwrap_or_default());
        let code = code.trim();
        let place = format!("{page}:{}: `{}`", command.line, command.typed);
        if is_begun(command) {
            // No recordings, no such run: 1. Interrupted: 130. Invalid arguments: 2.
            if !["0", "1", "130"].contains(&code) {
                faults.push(format!("{place} cannot be begun: exit code {code}\n{output}"));
            }
            continue;
        }
        let expected = shown::exit_code(command);
        if code != expected {
            faults.push(format!("{place}: exit code {code}, not {expected}\n{output}"));
        } else if let Some(lines) = shown::replacement(command, &output) {
            faults.push(format!("{place} prints something else:\n{output}"));
            new_text = shown::replaced(&new_text, command, &lines);
        }
    }
    if std::env::var_os("DDL_WRITE_SHOWN").is_some() {
        std::fs::write(checkout().join(page), new_text).unwrap();
    }
    assert!(faults.is_empty(), "{}\n{shell:?}", faults.join("\n"));
}

/// Writes what a reader of the page has before the first command: `target/release/ddl`, the checkout's `crates` and
/// `datasets/sample.csv`, and the simulated crowds of the folder `recordings`. The script makes the other files.
fn prepare(text: &str, folder: &Path) {
    let link = |from: &Path, name: &str| std::os::unix::fs::symlink(from, folder.join(name)).unwrap();
    for new in ["target/release", "datasets", "recordings"] {
        std::fs::create_dir_all(folder.join(new)).unwrap();
    }
    link(program::path(), "target/release/ddl");
    for name in ["crates", "datasets/sample.csv"] {
        link(&checkout().join(name), name);
    }
    for (name, scene) in [("hall", "plaza"), ("lobby", "crossing"), ("street", "corridor")] {
        let mut rows = own_tracks::of_scene(scene, 0..2000);
        for (frame, _, x, y) in &mut rows {
            *frame /= own_tracks::FRAME_STEP;
            [*x, *y] = [*x, *y].map(|metres| (metres * 100.0).round() / 100.0);
        }
        std::fs::write(folder.join(format!("recordings/{name}.csv")), own_tracks::csv(&rows)).unwrap();
    }
    if text.contains("--model runs/zara1") {
        folder_contents::write(drawn_model::contents(Variant::Full), &folder.join("runs/zara1"));
    }
}

/// The script of a page's commands, which writes the output and the exit code of each to `notes`.
fn script(commands: &[ConsoleCommand], is_begun: impl Fn(&ConsoleCommand) -> bool, notes: &Path) -> String {
    let (root, notes) = (checkout(), notes.display());
    let (root, empty) = (root.display(), format!("{notes}/empty"));
    let mut script = format!("mkdir {empty}\nsource {root}/tests/guide/inputs.sh {root}/datasets/sample.csv\n");
    for (i, command) in commands.iter().enumerate() {
        let typed = command.typed.as_str();
        let run = if is_begun(command) {
            // The program `time` may not be installed.
            let quoted = typed.trim_start_matches("/usr/bin/time ").replace('\'', r"'\''");
            format!("(cd {empty}; unset DDL_DATASETS; {BEGIN} -c '{quoted}')")
        } else {
            typed.to_owned()
        };
        // Formatting into a `String` cannot fail.
        let _ = writeln!(script, "{{ {run}\n}} > {notes}/{i}.output 2>&1 < /dev/null\necho $? > {notes}/{i}.code");
    }
    script
}

/// Checks that the packages, examples, benchmarks and tests named in a call of cargo exist.
fn check_cargo(page: &str, command: &ConsoleCommand) {
    let place = format!("{page}:{}", command.line);
    let words = command.words().unwrap_or_else(|| panic!("{place}: not a plain call of cargo"));
    let after = |option: &str| words.iter().skip_while(|&&word| word != option).nth(1).copied();
    let package = after("-p").unwrap_or_else(|| panic!("{place}: no package is named"));
    let (folder, tests) = match package {
        "ddl-tests" => ("tests".to_owned(), "."),
        "ddl-forecast" => ("crates/ddl".to_owned(), "tests"),
        _ => (format!("crates/{package}"), "tests"),
    };
    let folder = checkout().join(folder);
    assert!(folder.join("Cargo.toml").is_file(), "{place}: no package {package}");
    for (option, targets) in [("--example", "examples"), ("--bench", "benches"), ("--test", tests)] {
        let Some(name) = after(option) else { continue };
        let target = folder.join(targets).join(name);
        let exists = target.is_dir() || target.with_extension("rs").is_file();
        assert!(exists, "{place}: no {option} {name}");
    }
}
