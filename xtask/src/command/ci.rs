//! `cargo xtask ci`: everything that must hold, cheapest first, tests last.

use std::thread;
use std::time::Instant;

use anyhow::{Context, Result};
use ddl_data::Convention;

use super::{benchmark, data, deny, docs, package, page, python, set_up, test};
use crate::tidy;
use crate::workspace::{Workspace, step};

type Check = (&'static str, fn(&Workspace) -> Result<()>);

const CHECKS: [Check; 10] = [
    ("format", format),
    ("tidy", tidy::run),
    ("packages", package::check),
    ("recordings from the package index", recordings),
    ("what comes in from outside", deny::run),
    ("set-up", set_up),
    ("lints", |workspace| lints(workspace, "ddl-cli/torch")),
    (
        "documentation, report page, benchmark; Python wheel",
        pages_benchmark_and_wheel,
    ),
    ("Python package", python::test_built),
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

pub(super) fn format(workspace: &Workspace) -> Result<()> {
    step(
        "`cargo fmt --all --check`",
        &workspace.cargo(["fmt", "--all", "--check"]),
    )
    .context("run `cargo fmt --all`")
}

pub(super) fn lints(workspace: &Workspace, features: &str) -> Result<()> {
    // Warnings are denied here and not by RUSTFLAGS, which would replace the path to libtorch.
    let arguments = [
        "clippy",
        "--workspace",
        "--all-targets",
        "--features",
        features,
        "--quiet",
        "--",
        "-D",
        "warnings",
    ];
    step("clippy", &workspace.cargo(arguments))
}

/// The pages and the benchmark keep one core busy, and the wheel, in a build folder of its own, another.
fn pages_benchmark_and_wheel(workspace: &Workspace) -> Result<()> {
    thread::scope(|scope| {
        let wheel = scope.spawn(|| python::build_wheel(&Workspace::find()?));
        docs::check(workspace)
            .context("documentation site")
            .and_then(|()| page::check(workspace).context("report page in a browser"))
            .and_then(|()| benchmark::smoke(workspace).context("benchmark"))?;
        let built = wheel.join();
        built.unwrap_or_else(|panic| std::panic::resume_unwind(panic))
    })
}

/// The package index is where a machine gets real recordings that reaches nothing else.
fn recordings(workspace: &Workspace) -> Result<()> {
    println!(
        "{}",
        data::fetch_one(workspace, Convention::SocialGan, None)?
    );
    Ok(())
}
