//! The program `ddl`, run as a user runs it.

use crate::own_tracks::{self, Row};
use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::sync::OnceLock;
use std::time::SystemTime;

/// Variables that would change what the program does.
const VARIABLES: [&str; 3] = ["DDL_DATASETS", "DDL_COMMIT", "RUST_LOG"];

/// The program with the arguments of a command line, which are parted by blanks, to be run in
/// `folder`: nothing inherited that would change a result, and backtraces on, so that an error which
/// prints one is seen.
///
/// # Panics
/// If the program was not built, or is older than its sources.
#[must_use]
pub fn command(folder: &Path, command_line: &str) -> Command {
    undisturbed(path(), folder, command_line)
}

/// Any program, as [`command`].
pub(crate) fn undisturbed(program: &Path, folder: &Path, command_line: &str) -> Command {
    let mut command = Command::new(program);
    command
        .args(command_line.split_whitespace())
        .current_dir(folder)
        .stdin(Stdio::null())
        .env("OMP_NUM_THREADS", "1")
        .env("RUST_BACKTRACE", "1");
    for variable in VARIABLES {
        command.env_remove(variable);
    }
    command
}

/// Runs the program in `folder` to its end.
///
/// # Panics
/// If it cannot be started.
#[must_use]
pub fn run(folder: &Path, command_line: &str) -> Finished {
    let output = command(folder, command_line).output();
    let output = output.expect("the program can be started");
    Finished::new(format!("ddl {command_line}"), &output)
}

/// Forecasts rows of tracks, whole observations alone, with the model in `folder`, where they are written to `tracks.csv`.
///
/// # Panics
/// If they cannot be written, or the program cannot be started.
#[must_use]
pub fn forecast(folder: &Path, rows: &[Row], options: &str) -> Finished {
    std::fs::write(folder.join("tracks.csv"), own_tracks::csv(rows)).expect("a csv can be written");
    let command_line = format!("forecast --model . tracks.csv --whole --threads 1 {options}");
    run(folder, &command_line)
}

/// How a run of the program ended.
#[derive(Debug)]
pub struct Finished {
    /// What was run.
    pub command: String,
    /// The exit code; `None` when a signal ended it.
    pub code: Option<i32>,
    /// Its results.
    pub stdout: String,
    /// What it told people.
    pub stderr: String,
}

impl Finished {
    /// What the output of a finished process says.
    #[must_use]
    pub fn new(command: String, output: &Output) -> Self {
        let text = |bytes| String::from_utf8_lossy(bytes).into_owned();
        Self {
            command,
            code: output.status.code(),
            stdout: text(&output.stdout),
            stderr: text(&output.stderr),
        }
    }

    /// Its standard output, after it went well.
    ///
    /// # Panics
    /// If it did not.
    #[must_use]
    pub fn succeeds(self) -> String {
        assert_eq!(self.code, Some(0), "{self:#?}");
        self.stdout
    }

    /// Its error message, after it failed as a good program does: exit code 1, nothing on standard
    /// output, one line on standard error that begins with `error: ` and says nothing twice.
    ///
    /// # Panics
    /// If it failed otherwise, or not at all.
    #[must_use]
    pub fn fails(self) -> String {
        assert_eq!(self.code, Some(1), "{self:#?}");
        assert_eq!(self.stdout, "", "{self:#?}");
        let message = self.stderr.strip_prefix("error: ").unwrap_or_default();
        let message = message.trim_end();
        assert!(
            !message.is_empty() && message.lines().count() == 1,
            "not one error message: {self:#?}"
        );
        for trace in ["panicked at", "RUST_BACKTRACE", "stack backtrace"] {
            assert!(!message.contains(trace), "{self:#?}");
        }
        let mut parts: Vec<&str> = message.split(": ").collect();
        parts.sort_unstable();
        assert!(
            parts.windows(2).all(|pair| pair[0] != pair[1]),
            "said twice: {self:#?}"
        );
        message.to_owned()
    }
}

/// Where the program lies.
///
/// # Panics
/// If it was not built, or is older than its sources.
#[must_use]
pub fn path() -> &'static Path {
    static PATH: OnceLock<PathBuf> = OnceLock::new();
    PATH.get_or_init(|| built(Path::new("ddl"), "-p ddl-cli"))
}

/// A program of the profile of this test, by its place among what cargo builds, such as `examples/live`; `target` is what
/// `cargo build` is told to make it.
///
/// # Panics
/// If it was not built, or is older than its sources.
pub(crate) fn built(place: &Path, target: &str) -> PathBuf {
    let path = beside_this_test(place);
    assert!(
        path.is_file(),
        "{} is missing; build it with `{}`",
        path.display(),
        build_command(target)
    );
    if let Some(newer) = newer_source(&path) {
        panic!(
            "{} is older than {}; build it anew with `{}`",
            path.display(),
            newer.display(),
            build_command(target)
        );
    }
    path
}

/// Cargo puts tests into `deps`, one below the programs of the same profile.
fn profile_folder() -> PathBuf {
    let test = std::env::current_exe().expect("a running test has a path");
    let deps = test.parent().unwrap_or(&test);
    let profile = if deps.ends_with("deps") {
        deps.parent().unwrap_or(deps)
    } else {
        deps
    };
    profile.to_path_buf()
}

fn beside_this_test(place: &Path) -> PathBuf {
    let mut path = profile_folder().join(place).into_os_string();
    path.push(std::env::consts::EXE_SUFFIX);
    path.into()
}

fn build_command(target: &str) -> String {
    let profile = profile_folder();
    match profile.file_name().and_then(OsStr::to_str) {
        None | Some("debug") => format!("cargo build {target}"),
        Some("release") => format!("cargo build {target} --release"),
        Some(other) => format!("cargo build {target} --profile {other}"),
    }
}

/// A source changed after the program was built, of those that cargo lists beside it. Pages included
/// as documentation do not count: they change nothing that the program does.
fn newer_source(program: &Path) -> Option<PathBuf> {
    let list = std::fs::read_to_string(program.with_extension("d")).ok()?;
    let (_, sources) = list.split_once(": ")?;
    let built = modified(program)?;
    sources
        .trim_end()
        .replace("\\ ", "\0")
        .split(' ')
        .map(|source| PathBuf::from(source.replace('\0', " ")))
        .filter(|source| source.extension() != Some(OsStr::new("md")))
        .find(|source| modified(source).is_some_and(|time| time > built))
}

fn modified(path: &Path) -> Option<SystemTime> {
    path.metadata().ok()?.modified().ok()
}
