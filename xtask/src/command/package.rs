//! `cargo xtask package`: packs the crates as for a registry.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail};
use clap::Args;
use serde_json::Value;

use crate::workspace::{Workspace, step};

/// Size limit of registries for a compressed package, in bytes.
const LIMIT: u64 = 10 * 1024 * 1024;
const NEEDED: [&str; 4] = ["Cargo.toml", "README.md", "LICENSE-MIT", "LICENSE-APACHE"];
/// Folders whose files may be left out of a package, because users of the crate do not build them.
const SPARED: [&str; 3] = ["tests", "benches", "examples"];

#[derive(Debug, Args)]
pub(crate) struct Arguments {
    /// Also build every package from its own files, as publishing does; takes minutes, mainly for the binding of
    /// libtorch
    #[arg(long)]
    verify: bool,
}

impl Arguments {
    pub(crate) fn run(self, workspace: &Workspace) -> Result<()> {
        check(workspace)?;
        if !self.verify {
            return Ok(());
        }
        super::set_up(workspace)?;
        // Packages are built without the workspace's profiles; a separate folder keeps the two builds from invalidating
        // each other.
        let place = ["--target-dir", "target/publish"];
        let publish = workspace.cargo(["publish", "--workspace", "--dry-run", "--allow-dirty"]);
        step("`cargo publish --dry-run`", &publish.args(place))
    }
}

/// Packs every published crate without building it, and checks the contents and size of the packages.
pub(crate) fn check(workspace: &Workspace) -> Result<()> {
    let pack = ["package", "--workspace", "--quiet", "--no-verify", "--allow-dirty"];
    step("`cargo package --no-verify`", &workspace.cargo(pack))?;
    let metadata = workspace.metadata()?;
    let tracked = workspace.files()?;
    let mut faults = Vec::new();
    println!("package             files  compressed");
    let packages = metadata["packages"].as_array().into_iter().flatten();
    // `publish = false` is an empty list here.
    for package in packages.filter(|package| package["publish"].is_null()) {
        let text = |field: &str| {
            package[field]
                .as_str()
                .with_context(|| format!("a crate has no {field}"))
        };
        let name = text("name")?;
        let packed = packed_files(workspace, name)?;
        let archive = format!("package/{name}-{}.crate", text("version")?);
        let archive = Path::new(target(&metadata)?).join(archive);
        let bytes = fs::metadata(&archive)
            .with_context(|| format!("{} was not made", archive.display()))?
            .len();
        println!("{name:<16} {:>8} {:>7} KiB", packed.len(), bytes.div_ceil(1024));
        let folder = Path::new(text("manifest_path")?).parent();
        let folder = folder.and_then(|folder| folder.strip_prefix(workspace.root()).ok());
        let folder = folder.context("a crate lies outside the workspace")?;
        let own = tracked.iter().filter_map(|file| file.strip_prefix(folder).ok());
        faults.extend(faults_of(name, own, &packed, bytes));
    }
    for fault in &faults {
        println!("fault: {fault}");
    }
    if !faults.is_empty() {
        bail!("package: {} faults (above)", faults.len());
    }
    Ok(())
}

fn target(metadata: &Value) -> Result<&str> {
    let folder = metadata["target_directory"].as_str();
    folder.context("`cargo metadata` names no target folder")
}

fn packed_files(workspace: &Workspace, name: &str) -> Result<BTreeSet<PathBuf>> {
    let list = workspace.cargo(["package", "--list", "--allow-dirty", "-p", name]);
    let list = list.quiet().ignore_stderr().read();
    let list = list.with_context(|| format!("`cargo package --list -p {name}` failed"))?;
    Ok(list.lines().map(PathBuf::from).collect())
}

/// Faults of a package; `own` are the files that git tracks in the crate's folder.
fn faults_of<'a>(
    name: &str,
    own: impl Iterator<Item = &'a Path>,
    packed: &BTreeSet<PathBuf>,
    bytes: u64,
) -> Vec<String> {
    let needed = NEEDED.iter().map(Path::new);
    let own = own.filter(|file| !SPARED.iter().any(|folder| file.starts_with(folder)));
    let expected: BTreeSet<&Path> = needed.chain(own).collect();
    let missing = expected.into_iter().filter(|file| !packed.contains(*file));
    let mut faults: Vec<String> = missing
        .map(|file| format!("{name}: {} is not in the package", file.display()))
        .collect();
    if bytes > LIMIT {
        faults.push(format!(
            "{name}: {bytes} bytes; registries take {LIMIT}: leave files out with `exclude`"
        ));
    }
    faults
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn required_files_must_be_in_the_package() {
        let own = ["Cargo.toml", "src/lib.rs", "models/eth.safetensors", "tests/a.rs"];
        let faults = |packed: &[&str], bytes| {
            let packed = packed.iter().map(PathBuf::from).collect();
            faults_of("ddl-forecast", own.iter().map(Path::new), &packed, bytes)
        };
        let whole = [&NEEDED[..], &["src/lib.rs", "models/eth.safetensors"]].concat();
        assert_eq!(faults(&whole, LIMIT), [] as [&str; 0]);
        assert_eq!(
            faults(&whole[..5], LIMIT),
            ["ddl-forecast: models/eth.safetensors is not in the package"]
        );
        assert_eq!(
            faults(&whole[1..], LIMIT),
            ["ddl-forecast: Cargo.toml is not in the package"]
        );
        assert!(faults(&whole, LIMIT + 1)[0].contains("10485760"));
    }
}
