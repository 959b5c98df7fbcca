//! `cargo xtask package`: the crates as a registry would get them.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail};
use clap::Args;
use serde_json::Value;

use crate::workspace::{Workspace, step};

/// Registries take no package beyond this, in bytes, compressed.
const LIMIT: u64 = 10 * 1024 * 1024;
/// What every package holds besides its sources.
const NEEDED: [&str; 4] = ["Cargo.toml", "README.md", "LICENSE-MIT", "LICENSE-APACHE"];
/// Folders of which a package may leave files out, because nothing that is built by those who use it needs them.
const SPARED: [&str; 3] = ["tests", "benches", "examples"];

#[derive(Debug, Args)]
pub(crate) struct Arguments {
    /// Also build every package from what is in it, as publishing does: minutes, most of them for the binding of libtorch
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
        let metadata = workspace.metadata()?;
        let publish = workspace
            .cargo(["publish", "--dry-run", "--allow-dirty"])
            // Packages are built without the workspace's profiles: side by side, neither build undoes the other.
            .args(["--target-dir", "target/publish"])
            .args(selection(&published(&metadata)));
        step("`cargo publish --dry-run`", &publish)
    }
}

/// Packs every crate that is published, builds nothing, and looks at what is in the packages and how large they are.
pub(crate) fn check(workspace: &Workspace) -> Result<()> {
    let metadata = workspace.metadata()?;
    let packages = published(&metadata);
    if packages.is_empty() {
        bail!("no crate of the workspace is published");
    }
    // Packed together, because they depend on each other and are in no registry yet.
    let pack = workspace
        .cargo(["package", "--quiet", "--no-verify", "--allow-dirty"])
        .args(selection(&packages));
    step("`cargo package --no-verify`", &pack)?;
    let target = metadata["target_directory"]
        .as_str()
        .context("`cargo metadata` names no target folder")?;
    let tracked = workspace.files()?;
    let mut faults = Vec::new();
    println!("package        version   files  compressed");
    for package in &packages {
        let files = packed_files(workspace, package)?;
        let bytes = size(target, package)?;
        println!(
            "{:<14} {:<8} {:>6} {:>7} KiB",
            package.name,
            package.version,
            files.len(),
            bytes.div_ceil(1024)
        );
        let folder = package.folder.strip_prefix(workspace.root());
        let folder = folder.unwrap_or(&package.folder);
        let own = tracked
            .iter()
            .filter_map(|file| file.strip_prefix(folder).ok());
        faults.extend(faults_of(package.name, own, &files, bytes));
    }
    for fault in &faults {
        println!("fault: {fault}");
    }
    if !faults.is_empty() {
        bail!("package: {} faults (above)", faults.len());
    }
    Ok(())
}

/// A crate that others can take.
#[derive(Debug)]
struct Package<'a> {
    name: &'a str,
    version: &'a str,
    folder: PathBuf,
}

fn published(metadata: &Value) -> Vec<Package<'_>> {
    let packages = metadata["packages"].as_array().into_iter().flatten();
    packages
        .filter(|package| package["publish"].is_null())
        .filter_map(|package| {
            Some(Package {
                name: package["name"].as_str()?,
                version: package["version"].as_str()?,
                folder: Path::new(package["manifest_path"].as_str()?)
                    .parent()?
                    .to_path_buf(),
            })
        })
        .collect()
}

/// The packages, as cargo is told.
fn selection<'a>(packages: &[Package<'a>]) -> Vec<&'a str> {
    packages
        .iter()
        .flat_map(|package| ["-p", package.name])
        .collect()
}

fn packed_files(workspace: &Workspace, package: &Package<'_>) -> Result<BTreeSet<PathBuf>> {
    let list = workspace
        .cargo(["package", "--list", "--allow-dirty", "-p", package.name])
        .quiet()
        .ignore_stderr()
        .read()
        .with_context(|| format!("`cargo package --list -p {}` failed", package.name))?;
    Ok(list.lines().map(PathBuf::from).collect())
}

fn size(target: &str, package: &Package<'_>) -> Result<u64> {
    let file = format!("package/{}-{}.crate", package.name, package.version);
    let path = Path::new(target).join(file);
    let metadata =
        fs::metadata(&path).with_context(|| format!("{} was not made", path.display()))?;
    Ok(metadata.len())
}

/// What is wrong with a package; `own` are the files that git tracks in the crate's folder.
fn faults_of<'a>(
    name: &str,
    own: impl Iterator<Item = &'a Path>,
    packed: &BTreeSet<PathBuf>,
    bytes: u64,
) -> Vec<String> {
    let mut faults = Vec::new();
    for file in NEEDED
        .iter()
        .filter(|file| !packed.contains(Path::new(file)))
    {
        faults.push(format!("{name}: {file} is not in the package"));
    }
    let left_out = own.filter(|file| {
        let spared = SPARED.iter().any(|folder| file.starts_with(folder));
        !spared
            && !packed.contains(*file)
            && !NEEDED.iter().any(|needed| *file == Path::new(needed))
    });
    for file in left_out {
        faults.push(format!("{name}: {} is not in the package", file.display()));
    }
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
    use serde_json::json;

    fn packed(files: &[&str]) -> BTreeSet<PathBuf> {
        NEEDED.iter().chain(files).map(PathBuf::from).collect()
    }

    #[test]
    fn what_is_built_must_be_in_the_package() {
        let own = [
            "Cargo.toml",
            "src/lib.rs",
            "models/eth.safetensors",
            "tests/a.rs",
        ];
        let faults = |files: &[&str], bytes| {
            faults_of("ddl", own.iter().map(Path::new), &packed(files), bytes)
        };
        let whole = ["src/lib.rs", "models/eth.safetensors"];
        assert_eq!(faults(&whole, LIMIT), [] as [&str; 0]);
        assert_eq!(
            faults(&whole[..1], LIMIT),
            ["ddl: models/eth.safetensors is not in the package"]
        );
        assert!(faults(&whole, LIMIT + 1)[0].contains("10485760"));
        let bare = faults_of("ddl", std::iter::empty(), &BTreeSet::new(), 0);
        assert_eq!(bare.len(), NEEDED.len());
    }

    #[test]
    fn crates_for_ourselves_alone_are_not_packed() {
        let package = |name: &str, publish: Value| json!({ "name": name, "version": "0.1.0", "publish": publish, "manifest_path": "/w/a/Cargo.toml" });
        let metadata =
            json!({ "packages": [package("ddl", Value::Null), package("xtask", json!([]))] });
        assert_eq!(selection(&published(&metadata)), ["-p", "ddl"]);
    }
}
