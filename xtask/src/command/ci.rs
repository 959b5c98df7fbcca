//! `cargo xtask ci`: all checks, cheapest first, tests last.

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
    ("dependencies", deny::run),
    ("set-up", set_up),
    ("lints", |workspace| lints(workspace, "ddl-cli/torch,ddl-tests/torch")),
    (
        "documentation, report page, benchmark; Python wheel",
        pages_benchmark_and_wheel,
    ),
    ("Python package", python::test_built),
    // The tests are last, so that their results are at the end of the log.
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

/// The pages and the benchmark use one core; the wheel, in a separate build folder, uses another.
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

/// On a machine with no other network access, the package index is the only source of real recordings.
fn recordings(workspace: &Workspace) -> Result<()> {
    println!("{}", data::fetch_one(workspace, Convention::SocialGan, None)?);
    Ok(())
}
