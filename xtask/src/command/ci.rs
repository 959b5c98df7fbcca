//! `cargo xtask ci`: everything that must hold, cheapest first, tests last.

use std::io::Write as _;
use std::time::Instant;

use anyhow::{Context, Result, bail};
use ddl_data::Convention;

use super::{benchmark, data, deny, docs, package, page, set_up, test, tidy};
use crate::site;
use crate::workspace::{Workspace, step};

/// A named check of `ci`.
type Check = (&'static str, fn(&Workspace) -> Result<()>);

const CHECKS: [Check; 12] = [
    ("format", format),
    ("tidy", tidy::run),
    ("packages", package::check),
    ("recordings from the package index", recordings),
    ("what comes in from outside", deny::run),
    ("set-up", set_up),
    ("lints", lints),
    ("documentation", documentation),
    ("documentation site", docs::check),
    ("benchmark", benchmark::smoke),
    ("report page in a browser", page::check),
    // Last, and the last to print: what a reader of the log looks for is the test results.
    ("tests", test::run_all),
];

pub(crate) fn run(workspace: &Workspace) -> Result<()> {
    let start = Instant::now();
    for (index, (name, check)) in CHECKS.iter().enumerate() {
        eprintln!(
            "==== {}/{} {name} (after {:.0} s) ====",
            index + 1,
            CHECKS.len(),
            start.elapsed().as_secs_f64()
        );
        check(workspace).with_context(|| format!("ci stopped at: {name}"))?;
    }
    Ok(())
}

fn format(workspace: &Workspace) -> Result<()> {
    step(
        "`cargo fmt --all --check`",
        &workspace.cargo(["fmt", "--all", "--check"]),
    )
    .context("run `cargo fmt --all`")
}

fn lints(workspace: &Workspace) -> Result<()> {
    // Warnings are denied here and not by RUSTFLAGS, which would replace the path to libtorch.
    let arguments = [
        "clippy",
        "--workspace",
        "--all-targets",
        "--features",
        "ddl-cli/torch",
        "--quiet",
        "--",
        "-D",
        "warnings",
    ];
    step("clippy", &workspace.cargo(arguments))
}

/// Builds the documentation and fails on any warning.
///
/// `RUSTDOCFLAGS=-Dwarnings` would replace the path to libtorch that the examples need, so the
/// warnings are found in what rustdoc prints; cargo repeats them for pages it has kept.
fn documentation(workspace: &Workspace) -> Result<()> {
    site::make_room(workspace)?;
    let output = workspace
        .cargo([
            "doc",
            "--workspace",
            "--features",
            "ddl-cli/torch",
            "--no-deps",
        ])
        .ignore_status()
        .output()
        .context("cargo cannot be started")?;
    std::io::stderr()
        .write_all(&output.stderr)
        .context("the terminal is gone")?;
    if !output.status.success() {
        bail!("`cargo doc` failed (above)");
    }
    let warnings = count_warnings(&String::from_utf8_lossy(&output.stderr));
    if warnings > 0 {
        bail!("`cargo doc` has {warnings} warnings (above)");
    }
    Ok(())
}

/// Lines that begin a warning, coloured or not; cargo's closing count is one of them.
fn count_warnings(text: &str) -> usize {
    text.lines()
        .filter(|line| {
            let plain = line.trim_start_matches(|c: char| {
                c == '\u{1b}' || c == '[' || c == ';' || c == 'm' || c.is_ascii_digit()
            });
            plain.starts_with("warning:")
                || plain.starts_with("warning[")
                || plain.starts_with("warning\u{1b}")
        })
        .count()
}

/// The package index is where a machine gets real recordings that reaches nothing else.
fn recordings(workspace: &Workspace) -> Result<()> {
    println!(
        "{}",
        data::fetch_one(workspace, Convention::SocialGan, None)?
    );
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn warnings_are_counted_in_plain_and_coloured_output() {
        assert_eq!(
            count_warnings(" Documenting ddl v0.1.0\n    Finished `dev`\n"),
            0
        );
        assert_eq!(
            count_warnings("warning: unresolved link to `X`\n --> src/lib.rs\n"),
            1
        );
        let coloured = "\u{1b}[1m\u{1b}[33mwarning\u{1b}[0m: unresolved link\n";
        assert_eq!(count_warnings(coloured), 1);
        assert_eq!(count_warnings("a sentence with warning: inside\n"), 0);
    }

    #[test]
    fn tests_come_last() {
        assert_eq!(CHECKS.last().map(|(name, _)| *name), Some("tests"));
    }
}
