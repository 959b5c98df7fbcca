//! `cargo xtask ci`: all checks, cheapest first, tests last. `cargo xtask check`: the quick ones.

use super::{benchmark, c, docs, python, set_up, test};
use crate::browser;
use crate::process::{read, run as run_command};
use crate::recordings;
use crate::tidy;
use crate::tools::Tools;
use crate::workspace::Workspace;
use anyhow::{Context, Result, ensure};
use std::path::Path;
use std::thread;
use std::time::Instant;

type NamedCheck = (&'static str, fn(&Workspace) -> Result<()>);

/// The features of everything that is built here.
const FEATURES: &str = "ddl-cli/torch,ddl-tests/torch";

const CHECKS: [NamedCheck; 11] = [
    ("text", text),
    ("libtorch, recordings, browser, Python packages", bring_all_in),
    ("dependencies and packages", dependencies),
    ("lints", |workspace| lints(workspace, FEATURES)),
    ("documentation site", |workspace| docs::build(workspace, &format!("--features {FEATURES}"))),
    ("build", |workspace| test::build(workspace).and_then(|()| test::build_with_torch(workspace))),
    ("report page in a browser", report_page),
    ("benchmark", benchmark::smoke),
    ("Python package", python::check),
    ("library for C and C++", c::check),
    // The tests are last, so that their results are at the end of the log.
    ("tests", |workspace| test::TestArguments::default().run(workspace)),
];

pub(super) fn run(workspace: &Workspace) -> Result<()> {
    let start = Instant::now();
    for (index, (name, check)) in (1..).zip(CHECKS) {
        let seconds = start.elapsed().as_secs();
        eprintln!("==== {index}/{} {name} (after {seconds} s) ====", CHECKS.len());
        check(workspace).with_context(|| format!("ci stopped at: {name}"))?;
    }
    eprintln!("==== all passed after {} s ====", start.elapsed().as_secs());
    Ok(())
}

pub(super) fn check(workspace: &Workspace) -> Result<()> {
    text(workspace)?;
    // The feature `doc-only` also compiles the code for libtorch, without libtorch.
    lints(workspace, "ddl-cli/torch,ddl-tests/torch,ddl-cli/doc-only")
}

/// Format, spelling, rules of this repository, workflows, and links between its files.
fn text(workspace: &Workspace) -> Result<()> {
    run_command(&mut workspace.cargo(["fmt", "--all", "--check"])).context("run `cargo fmt --all`")?;
    tidy::run(workspace)?;
    let tools = Tools::ensure(workspace)?;
    for [program, arguments] in [
        ["ruff", "format --check --quiet"],
        ["ruff", "check --quiet"],
        ["typos", "--format brief"],
        ["zizmor", "--offline --quiet --strict-collection .github"],
    ] {
        run_command(tools.program(workspace, program).args(arguments.split(' ')))?;
    }
    let files = workspace.files()?;
    let pages = files.iter().filter(|file| file.extension() == Some("md".as_ref()));
    run_command(tools.program(workspace, "lychee").args(pages)).context("links lead nowhere (above)")
}

fn lints(workspace: &Workspace, features: &str) -> Result<()> {
    // Warnings are denied here and not by RUSTFLAGS, which would replace the path to libtorch.
    let arguments = format!("clippy --workspace --all-targets --quiet --features {features} -- -D warnings");
    run_command(&mut workspace.cargo(arguments.split(' ')))
}

/// Everything that comes from elsewhere, at the same time.
fn bring_all_in(workspace: &Workspace) -> Result<()> {
    let fetch = |workspace: &Workspace| run_command(&mut workspace.cargo(["fetch", "--locked", "--quiet"]));
    // One after the other, because both may call apt-get.
    let programs = |workspace: &Workspace| {
        browser::find_or_install()?;
        c::prepare()?;
        python::prepare(workspace)
    };
    let jobs: [fn(&Workspace) -> Result<()>; 4] = [set_up, recordings::bring_in, fetch, programs];
    thread::scope(|scope| {
        let jobs = jobs.map(|job| scope.spawn(move || job(workspace)));
        jobs.into_iter().try_for_each(|job| job.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic)))
    })
}

/// The dependencies against deny.toml, and the packages of the crates as for a registry.
fn dependencies(workspace: &Workspace) -> Result<()> {
    let mut deny = Tools::ensure(workspace)?.program(workspace, "cargo-deny");
    // Advisories are left out, because their database changes daily.
    // The lists of deny.toml also have crates that depend on another for tests alone, which it does not count.
    deny.args("--offline --locked --all-features check -A unused-wrapper bans licenses sources".split(' '));
    run_command(&mut deny).context("deny.toml forbids a dependency: remove it, or allow it there with a reason")?;
    let package = "package --workspace --no-verify --allow-dirty --quiet";
    run_command(&mut workspace.cargo(package.split(' ')))?;
    // Who only forecasts needs no crate that measures or trains.
    let tree = read(&mut workspace.cargo("tree -p ddl-forecast -e normal --prefix none".split(' ')))?;
    for name in ["ddl-eval", "ddl-report", "ddl-star"] {
        ensure!(!tree.contains(name), "ddl-forecast without features depends on {name}");
    }
    run_command(&mut workspace.cargo("check -p ddl-forecast --quiet".split(' ')))
}

/// The report page of the simulated crowds.
fn report_page(workspace: &Workspace) -> Result<()> {
    let folder = workspace.path("target/report-page");
    let mut make = Tools::ensure(workspace)?.python(&workspace.path("tests/page/make_page.py"));
    run_command(make.arg(&folder).arg(workspace.path("target/debug/ddl")))?;
    browser::check(workspace, "tests/page/check_page.py", &folder, None::<&Path>)
}
