//! `cargo xtask c`: the library for C and C++, installed with its headers, for `pkg-config` and `CMake`.

use crate::debian;
use crate::process::run;
use crate::workspace::{Workspace, absolute};
use anyhow::{Context, Result, ensure};
use clap::Args;
use std::fs;
use std::path::{Path, PathBuf};

const CRATE: &str = "crates/ddl-c";
/// Where the checks install.
const CHECKED: &str = "target/c";
/// Largest size of the shared library in bytes.
const LARGEST: u64 = 9_000_000;
/// What the static library needs of the system.
const NATIVE: &str = "-lgcc_s -lpthread -lm -ldl -lc";
/// A panic must not end the program that calls.
pub(super) const PROFILE: &str = "wheel";

#[derive(Debug, Args)]
pub(crate) struct CLibraryArguments {
    /// Where to install: into its folders include and lib
    #[arg(long, value_name = "DIR")]
    prefix: PathBuf,
}

impl CLibraryArguments {
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
pub(super) fn install(workspace: &Workspace, profile: &str, prefix: &Path) -> Result<()> {
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
        #[cfg(unix)]
        let named = std::os::unix::fs::symlink(target, lib.join(link));
        #[cfg(not(unix))]
        let named = fs::copy(lib.join(target), lib.join(link)).map(drop);
        named.context("the name of the library")?;
    }
    for (template, folder) in
        [("ddl.pc", "pkgconfig"), ("ddl-config.cmake", "cmake/ddl"), ("ddl-config-version.cmake", "cmake/ddl")]
    {
        let text = fs::read_to_string(source.join("cmake").join(template)).context(template)?;
        let text = text.replace("@VERSION@", version).replace("@SONAME@", &soname);
        fs::write(lib.join(folder).join(template), text.replace("@NATIVE@", NATIVE)).context(template)?;
    }
    Ok(())
}

/// What the check in `ci` needs besides a compiler.
pub(super) fn prepare() -> Result<()> {
    debian::ensure_program("cmake", &["cmake", "make"])?;
    debian::ensure_program("pkg-config", &["pkg-config"])
}

/// The check of `ci`, on the library that it has built with everything else.
pub(super) fn check(workspace: &Workspace) -> Result<()> {
    let prefix = workspace.path(CHECKED).join("debug");
    install(workspace, "debug", &prefix)?;
    test(workspace, &prefix, "gcc", DEVELOPMENT)?;
    test(workspace, &prefix, "gcc", SANITIZED)?;
    with_pkg_config(workspace, &prefix)
}

/// The check of `nightly`: the library that users get, by two compilers, under `AddressSanitizer` and valgrind.
pub(super) fn check_all(workspace: &Workspace) -> Result<()> {
    prepare()?;
    debian::ensure_program("valgrind", &["valgrind", "libc6-dbg"])?;
    debian::ensure_program("clang", &["clang", "libclang-rt-dev"])?;
    // Sanitizers watch malloc, which the pool does not call.
    build(workspace, "--no-default-features")?;
    let prefix = workspace.path(CHECKED).join("sanitized");
    install(workspace, PROFILE, &prefix)?;
    for (compiler, trial) in [("gcc", SANITIZED), ("clang", SANITIZED), ("gcc", WATCHED)] {
        test(workspace, &prefix, compiler, trial)?;
    }
    build(workspace, "")?;
    let prefix = workspace.path(CHECKED).join("released");
    install(workspace, PROFILE, &prefix)?;
    let library = prefix.join("lib/libddl.so");
    let size = fs::metadata(&library)?.len();
    println!("{} has {size} bytes", library.display());
    ensure!(size <= LARGEST, "that is more than {LARGEST}: find out what has grown");
    for compiler in ["gcc", "clang"] {
        test(workspace, &prefix, compiler, RELEASED)?;
    }
    with_pkg_config(workspace, &prefix)?;
    let bench = format!("bench --package ddl-c --profile {PROFILE} --bench overhead -- 1.02");
    let mut bench = workspace.cargo(bench.split(' '));
    run(bench.env("DDL_C_LIBRARY", library))
}

/// Name, flags of the compiler, option of `CMake`, tests that are left out.
type LibraryTrial = [&'static str; 4];
const RELEASED: LibraryTrial = ["released", "-O2", "-DPEOPLE=25", "none"];
const DEVELOPMENT: LibraryTrial = ["development", "-O2", "-DPEOPLE=6", "none"];
const SANITIZED: LibraryTrial =
    ["sanitized", "-g -fsanitize=address,undefined -fno-sanitize-recover=all", "-DPEOPLE=1", "allocations"];
const WATCHED: LibraryTrial =
    ["watched", "-g", "-DCMAKE_CROSSCOMPILING_EMULATOR=valgrind;--quiet;--error-exitcode=9", "allocations"];

/// Builds the example and the tests against an installed library with `CMake`, and runs them.
fn test(workspace: &Workspace, prefix: &Path, compiler: &str, trial: LibraryTrial) -> Result<()> {
    let [name, flags, option, left_out] = trial;
    let folder = prefix.join(format!("{compiler}-{name}"));
    let mut configure = workspace.program("cmake");
    configure.args(["-S", "crates/ddl-c/tests", option, "-B"]).arg(&folder);
    configure.arg(format!("-DCMAKE_PREFIX_PATH={}", prefix.display()));
    configure.arg(concat!("-DVERSION=", env!("CARGO_PKG_VERSION")));
    let plus = if compiler == "gcc" { "g++" } else { "clang++" };
    for (language, name) in [("C", compiler), ("CXX", plus)] {
        configure.arg(format!("-DCMAKE_{language}_COMPILER={name}"));
        configure.arg(format!("-DCMAKE_{language}_FLAGS={flags}"));
    }
    run(&mut configure)?;
    run(workspace.program("cmake").arg("--build").arg(&folder))?;
    let mut tests = workspace.program("ctest");
    tests.args(["--verbose", "--exclude-regex", left_out, "--test-dir"]);
    run(tests.arg(folder))
}

/// The program of the page, by its one line of a shell.
fn with_pkg_config(workspace: &Workspace, prefix: &Path) -> Result<()> {
    let line = "sed -n '/^```cpp$/,/^```$/p' docs/cpp.md | sed '/^```/d' > \"$1.cpp\" && \
                c++ -std=c++17 \"$1.cpp\" $(pkg-config --cflags --libs ddl) -o \"$1\" && exec \"$1\"";
    let lib = prefix.join("lib");
    let mut shell = workspace.program("sh");
    shell.args(["-c", line, "sh"]).arg(prefix.join("page"));
    shell.env("PKG_CONFIG_PATH", lib.join("pkgconfig"));
    run(shell.env("LD_LIBRARY_PATH", lib))
}
