//! `cargo xtask release`: everything that a version consists of, built and checked; to publish it, a person has keys.

use super::{c, set_up, web};
use crate::cache::{self, sha256};
use crate::debian;
use crate::process::{read, run};
use crate::rust_target;
use crate::tools::{Tools, cargo_tool};
use crate::workspace::{Workspace, remove_folder};
use anyhow::{Context, Result, ensure};
use clap::Args;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Instant;

const VERSION: &str = env!("CARGO_PKG_VERSION");
/// The folder of the files of a release.
const FILES: &str = "target/release-files";
/// The target of this machine.
const OWN: &str = "x86_64-unknown-linux-gnu";
/// The oldest C library on which wheel and C library work: that of manylinux2014.
const OLDEST_GLIBC: &str = "2.17";
/// The packages whose parts are listed, each a file of the release.
const LISTED: [&str; 4] = ["ddl-cli", "ddl-python", "ddl-c", "ddl-web"];

#[derive(Debug, Args)]
pub(crate) struct ReleaseArguments {
    /// Build and check everything, and publish nothing
    #[arg(long)]
    pub(super) dry_run: bool,
}

type ReleaseStep = (&'static str, fn(&Workspace, &Path) -> Result<()>);
const STEPS: [ReleaseStep; 7] = [
    ("crates", crates),
    ("wheels", wheels),
    ("npm package", npm_package),
    ("C library", c_library),
    ("program", program),
    ("lists of parts", lists_of_parts),
    ("checksums", checksums),
];

impl ReleaseArguments {
    pub(crate) fn run(self, workspace: &Workspace) -> Result<()> {
        let notes = notes(&fs::read_to_string(workspace.path("CHANGELOG.md"))?, self.dry_run)?;
        let status = read(workspace.program("git").args(["status", "--porcelain"]))?;
        ensure!(self.dry_run || status.is_empty(), "a release is a commit, but files have changed:\n{status}");
        let files = workspace.path(FILES);
        remove_folder(&files)?;
        fs::create_dir_all(&files)?;
        fs::write(files.join("notes.md"), notes)?;
        for (name, step) in STEPS {
            let start = Instant::now();
            step(workspace, &files).with_context(|| format!("release: {name}"))?;
            eprintln!("release: {name}: {} s", start.elapsed().as_secs());
        }
        println!("{}", files.display());
        if self.dry_run {
            return Ok(());
        }
        publish(workspace, &files)
    }
}

/// What the changelog says of this version; without a date it is not one to publish.
fn notes(changelog: &str, dry_run: bool) -> Result<String> {
    let start = format!("## {VERSION} - ");
    let section =
        changelog.split("\n## ").find_map(|part| format!("## {part}").strip_prefix(&start).map(str::to_owned));
    let section = section.with_context(|| format!("CHANGELOG.md has no section `{start}DATE`"))?;
    if section.starts_with("unreleased") {
        ensure!(dry_run, "CHANGELOG.md calls {VERSION} unreleased: write the date of the release");
        eprintln!("note: CHANGELOG.md calls {VERSION} unreleased");
    }
    Ok(format!("# DDL {VERSION}, {section}"))
}

/// Every crate as its package, in the order of their dependencies; each is built from it. cargo keeps the packages of a
/// folder by name and version alone, so each run has a new one.
fn crates(workspace: &Workspace, _: &Path) -> Result<()> {
    set_up(workspace)?;
    let folder = tempfile::tempdir_in(workspace.path("target"))?;
    let publish = "publish --workspace --dry-run --allow-dirty --target-dir";
    let mut cargo = workspace.cargo(publish.split(' '));
    run(cargo.arg(folder.path()).env("CARGO_PROFILE_DEV_DEBUG", "none"))
}

fn wheels(workspace: &Workspace, files: &Path) -> Result<()> {
    let tools = Tools::for_release(workspace)?;
    for target in [OWN, "aarch64-unknown-linux-gnu"] {
        let mut maturin = tools.program(workspace, "maturin");
        let options = "build --quiet --zig --profile wheel --compatibility manylinux2014 --manifest-path \
                       crates/ddl-python/Cargo.toml --target-dir target/portable --target";
        maturin.args(options.split_whitespace()).arg(target);
        maturin.arg("--out").arg(files);
        with_target(workspace, &mut maturin, target)?;
        run(&mut maturin)?;
    }
    Ok(())
}

/// Lets a command that calls cargo find the target's standard library; this machine's own is there. The flags replace
/// the configured ones, which name the folder of libtorch on this machine.
fn with_target(workspace: &Workspace, command: &mut Command, target: &str) -> Result<()> {
    if target != OWN {
        rust_target::prepare(workspace, target, command)?;
    }
    let flags = format!("--remap-path-prefix={}=.", workspace.root.display());
    command.env("RUSTFLAGS", flags);
    Ok(())
}

/// What is published names no folder of this machine.
fn check_paths(workspace: &Workspace, file: &Path) -> Result<()> {
    let bytes = fs::read(file).with_context(|| file.display().to_string())?;
    let here = [workspace.path("target"), cache::folder()?];
    for folder in here.map(|folder| folder.into_os_string().into_encoded_bytes()) {
        let is_named = bytes.windows(folder.len()).any(|part| part == folder);
        let named = String::from_utf8_lossy(&folder);
        ensure!(!is_named, "{} names {named}", file.display());
    }
    Ok(())
}

fn npm_package(workspace: &Workspace, files: &Path) -> Result<()> {
    debian::ensure_program("npm", &["npm"])?;
    web::build(workspace)?;
    let mut npm = workspace.program("npm");
    npm.args(["pack", "--silent", "--pack-destination"]).arg(files);
    run(npm.arg(workspace.path(web::PACKAGE)))
}

/// cargo with zig as its linker, in the folder `target/portable`.
fn zigbuild(workspace: &Workspace, target: &'static str, glibc: &str, options: &str) -> Result<()> {
    let mut cargo = Tools::for_release(workspace)?.program(workspace, "cargo-zigbuild");
    cargo.args(["zigbuild", "--quiet", "--target-dir", "target/portable", "--target"]);
    cargo.arg(format!("{target}{glibc}")).args(options.split(' '));
    with_target(workspace, &mut cargo, target)?;
    run(&mut cargo)
}

fn c_library(workspace: &Workspace, files: &Path) -> Result<()> {
    let target = OWN;
    let options = format!("--package ddl-c --profile {}", c::PROFILE);
    zigbuild(workspace, target, &format!(".{OLDEST_GLIBC}"), &options)?;
    let name = format!("ddl-c-{VERSION}-x86_64-linux");
    let prefix = workspace.path("target/portable").join(&name);
    c::install(workspace, &format!("portable/{target}/{}", c::PROFILE), &prefix)?;
    check_paths(workspace, &prefix.join("lib/libddl.so"))?;
    pack(workspace, files, &name)
}

fn program(workspace: &Workspace, files: &Path) -> Result<()> {
    let target = "x86_64-unknown-linux-musl";
    zigbuild(workspace, target, "", "--release --package ddl-cli")?;
    let name = format!("ddl-{VERSION}-x86_64-linux");
    let folder = workspace.path("target/portable").join(&name);
    fs::create_dir_all(&folder)?;
    let built = workspace.path("target/portable").join(target).join("release/ddl");
    fs::copy(&built, folder.join("ddl")).with_context(|| built.display().to_string())?;
    check_paths(workspace, &built)?;
    run(workspace
        .program(folder.join("ddl"))
        .args(["forecast", "datasets/sample.csv", "--fps", "2.5", "--last"])
        .stdout(std::process::Stdio::null()))?;
    pack(workspace, files, &name)
}

/// An archive of the folder of that name, with the licences.
fn pack(workspace: &Workspace, files: &Path, name: &str) -> Result<()> {
    let folder = workspace.path("target/portable").join(name);
    for licence in ["LICENSE-MIT", "LICENSE-APACHE"] {
        fs::copy(workspace.path(licence), folder.join(licence)).context(licence)?;
    }
    let mut tar = workspace.program("tar");
    tar.args(["--sort=name", "--owner=0", "--group=0", "-czf"]).arg(files.join(format!("{name}.tar.gz")));
    run(tar.arg("-C").arg(workspace.path("target/portable")).arg(name))
}

/// What each of the files is built from, as `CycloneDX`: the program writes a list beside the manifest of every crate.
fn lists_of_parts(workspace: &Workspace, files: &Path) -> Result<()> {
    let cyclonedx = cargo_tool(workspace, "cargo-cyclonedx", "0.5.9")?;
    run(workspace.program(&cyclonedx).args(["cyclonedx", "--format", "json"]))?;
    let crates = fs::read_dir(workspace.path("crates"))?.flatten();
    let others = ["xtask", "tests"].map(|name| workspace.path(name));
    for folder in crates.map(|entry| entry.path()).chain(others) {
        for list in of_extension(&folder, "json")? {
            let name = list.file_name().unwrap_or_default().display().to_string();
            match name.strip_suffix(".cdx.json") {
                Some(package) if LISTED.contains(&package) => {
                    fs::rename(&list, files.join(format!("{package}-{VERSION}.cdx.json"))).context(name)?;
                }
                Some(_) => fs::remove_file(&list).context(name)?,
                None => {}
            }
        }
    }
    Ok(())
}

fn checksums(_: &Workspace, files: &Path) -> Result<()> {
    let sums = of_extension(files, "")?.into_iter().map(|file| {
        let name = file.file_name().unwrap_or_default().display().to_string();
        Ok(format!("{}  {name}\n", sha256(&file)?))
    });
    fs::write(files.join("SHA256SUMS"), sums.collect::<Result<String>>()?).context("SHA256SUMS")
}

/// The files of a folder with this extension, or all, by name.
fn of_extension(folder: &Path, extension: &str) -> Result<Vec<PathBuf>> {
    let mut files: Vec<PathBuf> = fs::read_dir(folder)?.flatten().map(|entry| entry.path()).collect();
    files.retain(|file| extension.is_empty() || file.extension().is_some_and(|it| it == extension));
    files.sort();
    Ok(files)
}

/// Each program finds its key where it documents. What is published already is left alone.
fn publish(workspace: &Workspace, files: &Path) -> Result<()> {
    let release_plz = cargo_tool(workspace, "release-plz", "0.4.3")?;
    run(workspace.program(release_plz).arg("release"))?;
    let mut maturin = Tools::for_release(workspace)?.program(workspace, "maturin");
    maturin.args(["upload", "--skip-existing"]);
    run(maturin.args(of_extension(files, "whl")?))?;
    let this = format!("ddl-forecast@{VERSION}");
    let published = read(workspace.program("npm").args(["view", &this, "version"])).unwrap_or_default();
    if published.trim() != VERSION {
        let mut npm = workspace.program("npm");
        run(npm.arg("publish").args(of_extension(files, "tgz")?))?;
    }
    let files = files.display();
    println!("push the tag v{VERSION}, and attach the files of {files} to it");
    Ok(())
}

#[test]
fn the_notes_are_the_section_of_this_version() {
    let changelog = format!("# Changelog\n\n## {VERSION} - unreleased\n\n- new\n\n## 0.1.0 - 2026-01-01\n\n- old\n");
    let notes_of = |dry_run| notes(&changelog, dry_run);
    assert!(notes_of(true).unwrap().ends_with("unreleased\n\n- new\n"));
    assert!(notes_of(false).unwrap_err().to_string().contains("write the date"));
    assert!(notes("# Changelog\n", true).unwrap_err().to_string().contains(VERSION));
}
