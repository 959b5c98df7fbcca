//! `cargo xtask hook`: format, columns and spelling of what is staged, in a second. `xtask/hooks/pre-commit` calls it.

use crate::process::{read, run as run_command};
use crate::tidy;
use crate::tools::Tools;
use crate::workspace::Workspace;
use anyhow::{Context, Result, ensure};
use std::io::Write as _;
use std::path::PathBuf;
use std::process::Stdio;
use std::thread;

/// Relative to the root of each checkout.
const FOLDER: &str = "xtask/hooks";
/// The setting of git, and the value that this repository gives it.
const SETTING: [&str; 3] = ["config", "core.hooksPath", FOLDER];

/// Lets git call the hook, unless the clone has hooks of its own. Says what calls it.
pub(super) fn install(workspace: &Workspace) -> Result<String> {
    let git = |words: &[&str]| read(workspace.program("git").args(words));
    let kept = git(&SETTING[..2]).unwrap_or_default();
    if kept.is_empty() {
        git(&SETTING).context("the hook needs a git checkout")?;
    }
    let folder = if kept.is_empty() { FOLDER } else { kept.trim() };
    Ok(format!("git runs the hooks in {folder} before a commit"))
}

pub(super) fn run(workspace: &Workspace) -> Result<()> {
    let staged = ["diff", "--cached", "--name-only", "--diff-filter=d", "-z"];
    let names = read(workspace.program("git").args(staged)).context("the hook needs a git checkout")?;
    let files: Vec<PathBuf> = names.split('\0').filter(|name| !name.is_empty()).map(PathBuf::from).collect();
    if files.is_empty() {
        return Ok(());
    }
    let share = files.len().div_ceil(thread::available_parallelism().map_or(1, usize::from));
    let faults = thread::scope(|scope| {
        let shares: Vec<_> = files.chunks(share).map(|share| scope.spawn(move || faults(workspace, share))).collect();
        let of_shares = shares.into_iter().map(|share| share.join().unwrap_or_else(|p| std::panic::resume_unwind(p)));
        of_shares.collect::<Result<Vec<_>>>()
    })?
    .concat();
    ensure!(faults.is_empty(), "not committed:\n{}", faults.join("\n"));
    let Some(tools) = Tools::kept(workspace)? else { return Ok(()) };
    let mut typos = tools.program(workspace, "typos");
    run_command(typos.args(["--format", "brief", "--force-exclude"]).args(files))
}

fn faults(workspace: &Workspace, files: &[PathBuf]) -> Result<Vec<String>> {
    let mut faults = Vec::new();
    for file in files {
        // What is committed may be older than the file.
        let text = read(workspace.program("git").arg("show").arg(format!(":{}", file.display())));
        // Only text has lines to check.
        let Ok(text) = text else { continue };
        let of_file = tidy::text_faults(file, &text);
        faults.extend(of_file.iter().map(|fault| format!("{}: {fault}", file.display())));
        if file.extension().is_some_and(|kind| kind == "rs") && !is_formatted(workspace, &text)? {
            faults.push(format!("{}: run `cargo fmt --all`", file.display()));
        }
    }
    Ok(faults)
}

/// Whether rustfmt leaves a text as it is. The exit code of `--check` says nothing of a text that it gets as input.
fn is_formatted(workspace: &Workspace, text: &str) -> Result<bool> {
    let mut rustfmt = workspace.program("rustfmt");
    rustfmt.args(["--quiet", "--edition", "2024"]).stdin(Stdio::piped()).stdout(Stdio::piped());
    let mut child = rustfmt.spawn().context("rustfmt cannot be started")?;
    if let Some(mut input) = child.stdin.take() {
        input.write_all(text.as_bytes())?;
    }
    Ok(child.wait_with_output()?.stdout == text.as_bytes())
}

#[test]
fn a_staged_file_is_checked_as_it_would_be_committed() {
    let folder = tempfile::tempdir().unwrap();
    let workspace = Workspace::at(folder.path());
    let git = |words: &[&str]| read(workspace.program("git").args(words)).unwrap();
    git(&["init", "--quiet"]);
    assert!(run(&workspace).is_ok());
    let check = |name: &str, text: &str| {
        std::fs::write(folder.path().join(name), text).unwrap();
        git(&["add", "."]);
        let checked = faults(&workspace, &[PathBuf::from(name)]).unwrap();
        std::fs::write(folder.path().join(name), "").unwrap();
        checked
    };
    assert!(check("a.rs", "fn a() {}\n").is_empty());
    assert_eq!(check("a.rs", "fn a(){}\n"), ["a.rs: run `cargo fmt --all`"]);
    let long = check("a.md", &"word ".repeat(40));
    assert!(long.len() == 1 && long[0].contains("line 1 has more than"), "{long:?}");
    for turn in ["on", "kept"] {
        assert!(install(&workspace).unwrap().contains(FOLDER), "{turn}");
    }
    git(&["config", "core.hooksPath", "mine"]);
    assert!(install(&workspace).unwrap().contains("hooks in mine "));
}
