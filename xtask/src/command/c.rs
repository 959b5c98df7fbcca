//! `cargo xtask c`: the library for C and C++, installed with its headers, for pkg-config and CMake.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, ensure};
use clap::Args;

use crate::debian;
use crate::process::run;
use crate::workspace::{Workspace, absolute};

const CRATE: &str = "crates/ddl-c";
/// Where the checks install.
const CHECKED: &str = "target/c";
/// Largest size of the shared library in bytes.
const LARGEST: u64 = 9_000_000;
/// What the static library needs of the system.
const NATIVE: &str = "-lgcc_s -lpthread -lm -ldl -lc";
/// A panic must not end the program that calls.
const PROFILE: &str = "wheel";

#[derive(Debug, Args)]
pub(crate) struct Arguments {
    /// Where to install: into its folders include and lib
    #[arg(long, value_name = "DIR")]
    prefix: PathBuf,
}

impl Arguments {
    pub(crate) fn run(self, workspace: &Workspace) -> Result<()> {
        let prefix = absolute(&self.prefix)?;
        build(workspace, "")?;
        install(workspace, PROFILE, &prefix)?;
        println!("{}", prefix.join("lib/libddl.so").display());
        Ok(())
    }
}

fn build(workspace: &Workspace, options: &str) -> Result<()> {
    let build = format!("build --package ddl-c --profile {PROFILE} {options}");
    run(&mut workspace.cargo(build.split_whitespace()))
}

/// The library that was built in this folder of `target`, under `prefix`.
fn install(workspace: &Workspace, profile: &str, prefix: &Path) -> Result<()> {
    let [lib, include] = ["lib", "include"].map(|folder| prefix.join(folder));
    for folder in [&include, &lib.join("pkgconfig"), &lib.join("cmake/ddl")] {
        fs::create_dir_all(folder).with_context(|| format!("{} cannot be made", folder.display()))?;
    }
    let put = |from: &Path, to: &Path| {
        // A program that runs keeps the file that it has opened.
        let _ = fs::remove_file(to);
        fs::copy(from, to).with_context(|| format!("{} cannot be copied to {}", from.display(), to.display()))
    };
    let source = workspace.path(CRATE);
    for header in ["ddl.h", "ddl.hpp"] {
        put(&source.join("include").join(header), &include.join(header))?;
    }
    let version = env!("CARGO_PKG_VERSION");
    let series = version.rsplit_once('.').map_or(version, |(series, _)| series);
    let [file, soname] = [version, series].map(|version| format!("libddl.so.{version}"));
    let built = workspace.path("target").join(profile);
    put(&built.join("libddl_c.so"), &lib.join(&file))?;
    put(&built.join("libddl_c.a"), &lib.join("libddl.a"))?;
    for (link, target) in [(&soname, &file), (&"libddl.so".to_owned(), &soname)] {
        let _ = fs::remove_file(lib.join(link));
        std::os::unix::fs::symlink(target, lib.join(link)).context("the name of the library")?;
    }
    for (template, folder) in [
        ("ddl.pc", "pkgconfig"),
        ("ddl-config.cmake", "cmake/ddl"),
        ("ddl-config-version.cmake", "cmake/ddl"),
    ] {
        let text = fs::read_to_string(source.join("cmake").join(template)).context(template)?;
        let text = text.replace("@VERSION@", version).replace("@SONAME@", &soname);
        fs::write(lib.join(folder).join(template), text.replace("@NATIVE@", NATIVE)).context(template)?;
    }
    Ok(())
}

/// The compilers and tools of the checks.
pub(super) fn prepare() -> Result<()> {
    for (program, packages) in [
        ("cmake", &["cmake", "make"][..]),
        ("pkg-config", &["pkg-config"]),
        ("valgrind", &["valgrind", "libc6-dbg"]),
        ("clang", &["clang", "libclang-rt-dev"]),
    ] {
        debian::ensure_program(program, packages)?;
    }
    Ok(())
}

/// The check of `ci`, on the library that it has built with everything else.
pub(super) fn check(workspace: &Workspace) -> Result<()> {
    let prefix = workspace.path(CHECKED).join("debug");
    install(workspace, "debug", &prefix)?;
    test(workspace, &prefix, "gcc", Under::Nothing)?;
    with_pkg_config(workspace, &prefix)
}

/// The check of `nightly`: the library that users get, by two compilers, under `AddressSanitizer` and valgrind.
pub(super) fn check_all(workspace: &Workspace) -> Result<()> {
    prepare()?;
    // Sanitizers watch malloc, which the pool does not call.
    build(workspace, "--no-default-features")?;
    let prefix = workspace.path(CHECKED).join("sanitized");
    install(workspace, PROFILE, &prefix)?;
    for (compiler, under) in [
        ("gcc", Under::Sanitizers),
        ("clang", Under::Sanitizers),
        ("gcc", Under::Valgrind),
    ] {
        test(workspace, &prefix, compiler, under)?;
    }
    build(workspace, "")?;
    let prefix = workspace.path(CHECKED).join("released");
    install(workspace, PROFILE, &prefix)?;
    let library = prefix.join("lib/libddl.so");
    let size = fs::metadata(&library)?.len();
    println!("{} has {size} bytes", library.display());
    ensure!(size <= LARGEST, "that is more than {LARGEST}: find out what has grown");
    for compiler in ["gcc", "clang"] {
        test(workspace, &prefix, compiler, Under::Nothing)?;
    }
    with_pkg_config(workspace, &prefix)?;
    let mut bench = workspace.cargo("bench --package ddl-c --profile wheel --bench overhead -- 1.02".split(' '));
    run(bench.env("DDL_C_LIBRARY", library))
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Under {
    Nothing,
    Sanitizers,
    Valgrind,
}

/// Builds the example and the tests against an installed library with CMake, and runs them.
fn test(workspace: &Workspace, prefix: &Path, compiler: &str, under: Under) -> Result<()> {
    let folder = prefix.join(format!("{compiler}-{under:?}").to_lowercase());
    let flags = match under {
        Under::Nothing => "-O2",
        Under::Sanitizers => "-g -fsanitize=address,undefined -fno-sanitize-recover=all",
        Under::Valgrind => "-g",
    };
    let mut configure = workspace.program("cmake");
    configure.args(["-S", &format!("{CRATE}/tests"), "-B"]).arg(&folder);
    configure.arg(format!("-DCMAKE_PREFIX_PATH={}", prefix.display()));
    for (language, name) in [
        ("C", compiler),
        ("CXX", if compiler == "gcc" { "g++" } else { "clang++" }),
    ] {
        configure.arg(format!("-DCMAKE_{language}_COMPILER={name}"));
        configure.arg(format!("-DCMAKE_{language}_FLAGS={flags}"));
    }
    if under == Under::Valgrind {
        configure.arg("-DCMAKE_CROSSCOMPILING_EMULATOR=valgrind;--quiet;--error-exitcode=9");
    }
    run(&mut configure)?;
    run(workspace.program("cmake").arg("--build").arg(&folder))?;
    let mut tests = workspace.program("ctest");
    tests
        .arg("--test-dir")
        .arg(&folder)
        .args(["--output-on-failure", "--verbose"]);
    if under != Under::Nothing {
        tests.args(["--exclude-regex", "allocations"]);
    }
    run(&mut tests)
}

/// The example by one line of a shell.
fn with_pkg_config(workspace: &Workspace, prefix: &Path) -> Result<()> {
    let lib = prefix.join("lib");
    let line = format!(
        "c++ -std=c++17 {CRATE}/examples/planner/main.cpp $(pkg-config --cflags --libs ddl) -o \"$1\" && exec \"$1\""
    );
    let mut shell = workspace.program("sh");
    shell.args(["-c", &line, "sh"]).arg(prefix.join("planner"));
    run(shell
        .env("PKG_CONFIG_PATH", lib.join("pkgconfig"))
        .env("LD_LIBRARY_PATH", lib))
}
