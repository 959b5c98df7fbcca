//! `cargo xtask benchmark`: libtorch, the recordings and the program, then `ddl benchmark`.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result, bail};
use clap::Args;

use super::set_up;
use crate::process::run;
use crate::recordings;
use crate::workspace::Workspace;

#[derive(Debug, Args)]
pub(crate) struct Arguments {
    /// Options of `ddl benchmark`, such as `--profile smoke`; paths in them must lie below the checkout. `--convention`
    /// and `--data` also select the recordings to fetch, and `--publish` (without a folder) publishes in this checkout.
    /// `--cargo-profile dev` builds the program with less optimisation
    #[arg(trailing_var_arg = true, allow_hyphen_values = true, value_name = "OPTIONS")]
    options: Vec<String>,
}

impl Arguments {
    /// Replaces this process by the program, which then receives Ctrl-C and determines the exit code.
    pub(crate) fn run(self, workspace: &Workspace) -> Result<()> {
        use std::os::unix::process::CommandExt as _;
        let error = command(workspace, self.options)?.exec();
        Err(error).context("cargo cannot be started")
    }
}

/// The cargo command that builds the program and replaces itself by it.
fn command(workspace: &Workspace, mut options: Vec<String>) -> Result<Command> {
    let cargo_profile = take(&mut options, "--cargo-profile")?;
    let asked = take(&mut options, "--convention")?;
    let data = take(&mut options, "--data")?.map(PathBuf::from);
    let chosen = recordings::choose(workspace, asked.as_deref(), data.as_deref())?;
    eprintln!("data convention: {} ({})", chosen.convention, chosen.reason);
    set_up(workspace)?;
    let mut cargo = workspace.cargo("run --package ddl-cli --bin ddl --features torch --profile".split(' '));
    cargo
        .arg(cargo_profile.as_deref().unwrap_or("release"))
        .args(["--", "benchmark"])
        .args(handed_over(
            workspace.root(),
            &chosen.convention,
            chosen.folder.as_deref(),
            options,
        ));
    Ok(cargo)
}

fn handed_over(root: &Path, convention: &str, data: Option<&Path>, options: Vec<String>) -> Vec<String> {
    let mut words = vec!["--convention".to_owned(), convention.to_owned()];
    if let Some(folder) = data {
        words.extend(["--data".to_owned(), folder.display().to_string()]);
    }
    for option in options {
        let publishes = option == "--publish";
        words.push(option);
        if publishes {
            words.push(root.display().to_string());
        }
    }
    words
}

fn take(options: &mut Vec<String>, name: &str) -> Result<Option<String>> {
    let of_word = |word: &String| word.strip_prefix(name)?.strip_prefix('=').map(str::to_owned);
    if let Some(index) = options.iter().position(|word| of_word(word).is_some()) {
        return Ok(of_word(&options.remove(index)));
    }
    let Some(index) = options.iter().position(|word| word == name) else {
        return Ok(None);
    };
    if index + 1 == options.len() {
        bail!("{name} needs a value");
    }
    options.remove(index);
    Ok(Some(options.remove(index)))
}

/// The benchmark as `ci` runs it: small, under every protocol, in a separate folder, from the start, and without a
/// second build of everything.
pub(super) fn smoke(workspace: &Workspace) -> Result<()> {
    let out = workspace.path("target/ci-benchmark");
    if out.exists() {
        fs::remove_dir_all(&out).with_context(|| format!("{} cannot be deleted", out.display()))?;
    }
    let options = "--profile smoke --protocol published,fair,single --cargo-profile dev --out";
    let mut options: Vec<String> = options.split(' ').map(str::to_owned).collect();
    options.push(out.display().to_string());
    run(&mut command(workspace, options)?)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn own_options_are_removed_and_the_rest_is_passed_on() {
        let words = "--profile smoke --convention=star --publish --data here --seeds 1".split(' ');
        let mut options: Vec<String> = words.map(str::to_owned).collect();
        let mut taken = |name| take(&mut options, name).unwrap();
        assert_eq!(taken("--convention").as_deref(), Some("star"));
        assert_eq!(taken("--data").as_deref(), Some("here"));
        assert_eq!(taken("--cargo-profile"), None);
        let words = handed_over(Path::new("/checkout"), "star", Some(Path::new("/found")), options);
        let expected = "--convention star --data /found --profile smoke --publish /checkout --seeds 1";
        assert_eq!(words.join(" "), expected);
        let error = take(&mut vec!["--data".to_owned()], "--data").unwrap_err();
        assert_eq!(error.to_string(), "--data needs a value");
    }
}
