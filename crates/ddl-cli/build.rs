//! Records the commit that the program is built from, for the results.

use std::path::Path;
use std::process::Command;

fn main() {
    println!("cargo::rustc-env=DDL_BUILT_FROM={}", commit());
}

/// The commit of the checkout, shortened as in the results; `unknown` without a checkout or git.
fn commit() -> String {
    let unknown = || "unknown".to_owned();
    // A package that was unpacked inside another checkout does not belong to that checkout.
    let in_workspace = Path::new("../../crates/ddl-cli/build.rs").is_file();
    let folder = git(&["rev-parse", "--absolute-git-dir"]).filter(|_| in_workspace);
    let Some(folder) = folder else {
        println!("cargo::rerun-if-changed=build.rs");
        return unknown();
    };
    // Git writes this file at every commit, checkout and merge.
    let log = Path::new(&folder).join("logs/HEAD");
    let moves = if log.is_file() { log } else { Path::new(&folder).join("HEAD") };
    println!("cargo::rerun-if-changed={}", moves.display());
    // An edit makes the program differ from the commit.
    println!("cargo::rerun-if-changed=../../crates");
    git(&["describe", "--always", "--dirty", "--exclude=*", "--abbrev=12"]).unwrap_or_else(unknown)
}

fn git(arguments: &[&str]) -> Option<String> {
    let output = Command::new("git").args(arguments).output().ok()?;
    let answer = String::from_utf8(output.stdout).ok()?;
    output.status.success().then(|| answer.trim().to_owned()).filter(|answer| !answer.is_empty())
}
