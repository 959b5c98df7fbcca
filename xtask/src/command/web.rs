//! `cargo xtask web`: the forecaster as WebAssembly, in a page of one file and in an npm package.

use crate::browser;
use crate::debian;
use crate::process::run;
use crate::rust_target;
use crate::tools::Tools;
use crate::workspace::{Workspace, remove_folder};
use anyhow::{Context, Result};
use clap::Args;
use std::fs;
use std::path::Path;

/// The folder of page and package.
const MADE: &str = "target/web";
pub(super) const PACKAGE: &str = "target/web/npm";
const TARGET: &str = "wasm32-unknown-unknown";
/// What cargo makes, in a folder of its own, because the compiler may be another one.
const BUILT: &str = "target/wasm";
/// What the test of the example installs.
const PACKAGES: [&str; 2] = ["typescript@5.9.3", "@types/node@22.20.5"];

#[derive(Debug, Default, Args)]
pub(crate) struct WebArguments {
    /// Also test both: the page in a browser, the package in node
    #[arg(long)]
    test: bool,
}

impl WebArguments {
    pub(crate) fn run(self, workspace: &Workspace) -> Result<()> {
        build(workspace)?;
        if self.test {
            check(workspace)?;
        }
        Ok(())
    }
}

pub(super) fn build(workspace: &Workspace) -> Result<()> {
    let options = format!("build --release --quiet -p ddl-web --target-dir {BUILT} --target {TARGET}");
    let mut cargo = workspace.cargo(options.split(' '));
    rust_target::prepare(workspace, TARGET, &mut cargo)?;
    // The kernels compute with vectors of 128 bits, which every browser since 2023 has.
    run(cargo.env("RUSTFLAGS", "-C target-feature=+simd128"))?;
    let package = workspace.path(PACKAGE);
    let bindgen = "run --quiet --package xtask --features bindgen --bin bindgen --target-dir target/xtask --";
    let mut bindgen = workspace.cargo(bindgen.split(' '));
    bindgen.arg(workspace.path(BUILT).join(TARGET).join("release/ddl_forecast.wasm")).arg(&package);
    run(bindgen.arg(workspace.path(BUILT).join("page")))?;
    let sources = ["crates/ddl-web/npm/node.js", "crates/ddl-web/README.md", "LICENSE-MIT", "LICENSE-APACHE"];
    for file in sources {
        let name = Path::new(file).file_name().unwrap_or_default();
        fs::copy(workspace.path(file), package.join(name)).with_context(|| file.to_owned())?;
    }
    let mut assemble = Tools::ensure(workspace)?.python(&workspace.path("xtask/src/python/web.py"));
    run(assemble.arg(&workspace.root).arg(env!("CARGO_PKG_VERSION")))
}

/// The page in a browser, and the package in node, against the program.
pub(super) fn check(workspace: &Workspace) -> Result<()> {
    run(&mut workspace.cargo("build --quiet -p ddl-cli".split(' ')))?;
    let made = workspace.path(MADE);
    let pictures = made.join("screenshots");
    browser::check(workspace, "tests/page/check_web.py", &made, Some(&pictures))?;
    debian::ensure_program("npm", &["npm"])?;
    // The example, as somebody else's program.
    let user = made.join("user");
    // npm would keep an older package of the same version.
    remove_folder(&user)?;
    fs::create_dir_all(&user)?;
    for entry in fs::read_dir(workspace.path("crates/ddl-web/examples"))?.flatten() {
        fs::copy(entry.path(), user.join(entry.file_name()))?;
    }
    let mut npm = workspace.program("npm");
    npm.args("install --install-links --no-audit --no-fund --no-save --prefix".split(' ')).arg(&user);
    run(npm.args(PACKAGES).arg(made.join("npm")))?;
    let mut types = workspace.program(user.join("node_modules/.bin/tsc"));
    run(types.arg("--project").arg(&user))?;
    let mut example = workspace.program("node");
    example.arg(user.join("forecast.js"));
    run(example.arg(workspace.path("datasets/sample.csv")))?;
    run(workspace.program("node").args(["--test", "tests/page/check_npm.mjs"]))
}
