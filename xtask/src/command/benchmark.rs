//! `cargo xtask benchmark`: libtorch, the recordings and the program, then `ddl benchmark`.

use super::set_up;
use crate::process::run;
use crate::recordings::bring_in_for;
use crate::workspace::{Workspace, remove_folder};
use anyhow::{Context, Result};
use clap::Args;

#[derive(Debug, Args)]
pub(crate) struct BenchmarkArguments {
    /// Options of `ddl benchmark`, such as `--profile smoke`; paths in them are relative to the checkout
    #[arg(trailing_var_arg = true, allow_hyphen_values = true, value_name = "OPTIONS")]
    options: Vec<String>,
}

impl BenchmarkArguments {
    /// Replaces this process by the program, which then receives Ctrl-C and determines the exit code.
    pub(crate) fn run(self, workspace: &Workspace) -> Result<()> {
        let data = value(&self.options, "--data").map(|folder| workspace.path(folder));
        bring_in_for(workspace, value(&self.options, "--convention"), data.as_deref())?;
        set_up(workspace)?;
        let mut cargo =
            workspace.cargo("run --release --package ddl-cli --bin ddl --features torch -- benchmark".split(' '));
        cargo.args(self.options);
        #[cfg(unix)]
        return Err(std::os::unix::process::CommandExt::exec(&mut cargo)).context("cargo cannot be started");
        #[cfg(not(unix))]
        run(&mut cargo).context("the benchmark stopped (above)")
    }
}

/// The value of an option of `ddl benchmark`.
fn value<'a>(options: &'a [String], name: &str) -> Option<&'a str> {
    let mut words = options.iter().enumerate();
    words.find_map(|(index, word)| match word.strip_prefix(name)? {
        "" => options.get(index + 1).map(String::as_str),
        rest => rest.strip_prefix('='),
    })
}

/// The benchmark as `ci` runs it: small, under every protocol, in a separate folder, from the start, with the program
/// that `ci` has built.
pub(super) fn smoke(workspace: &Workspace) -> Result<()> {
    remove_folder(&workspace.path("target/ci-benchmark"))?;
    let options = "benchmark --profile smoke --protocol published,fair,single --out target/ci-benchmark";
    run(workspace.program(workspace.path("target/debug/ddl")).args(options.split(' ')))
}

#[test]
fn both_spellings_of_an_option_are_read() {
    let options = ["--data-x", "--convention=star", "--data", "here"].map(str::to_owned);
    let values = ["--convention", "--data", "--out"].map(|name| value(&options, name));
    assert_eq!(values, [Some("star"), Some("here"), None]);
}
