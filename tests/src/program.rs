//! The program `ddl`, run as by a user, and built first if necessary.

use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::sync::OnceLock;
use std::time::SystemTime;

/// Environment variables that would change the behaviour of the program.
const VARIABLES: [&str; 3] = ["DDL_DATASETS", "DDL_COMMIT", "RUST_LOG"];

/// The program with the arguments of a command line, separated by blanks, to be run in `folder`. Inherited variables
/// that could change a result are removed. Backtraces are enabled, so that an error that prints one is noticed.
pub fn command(folder: &Path, command_line: &str) -> Command {
    undisturbed(path(), folder, command_line)
}

/// Any program, with the environment of [`command`].
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
pub fn run(folder: &Path, command_line: &str) -> Finished {
    let output = command(folder, command_line).output().expect("the program can be started");
    Finished::new(format!("ddl {command_line}"), &output)
}

/// The result of a run of the program.
#[derive(Debug)]
pub struct Finished {
    /// The command line.
    pub command: String,
    /// The exit code; `None` if a signal ended it.
    pub code: Option<i32>,
    /// Its standard output.
    pub stdout: String,
    /// Its standard error.
    pub stderr: String,
}

impl Finished {
    /// The result of a finished process.
    pub fn new(command: String, output: &Output) -> Self {
        let text = |bytes| String::from_utf8_lossy(bytes).into_owned();
        Self { command, code: output.status.code(), stdout: text(&output.stdout), stderr: text(&output.stderr) }
    }

    /// Asserts success, and returns the standard output.
    pub fn succeeds(self) -> String {
        assert_eq!(self.code, Some(0), "{self:#?}");
        self.stdout
    }

    /// Asserts that its standard error holds these words, and returns it itself.
    #[must_use]
    pub fn says(self, words: &str) -> Self {
        assert!(self.stderr.contains(words), "{words}: {self:#?}");
        self
    }

    /// Asserts failure, and returns the error message. A failure must have exit code 1, no standard output, and one
    /// line on standard error, behind notes, that begins with `error: ` and repeats nothing.
    pub fn fails(self) -> String {
        assert_eq!(self.code, Some(1), "{self:#?}");
        assert_eq!(self.stdout, "", "{self:#?}");
        let lines: String = self.stderr.split_inclusive('\n').skip_while(|line| line.starts_with("note: ")).collect();
        let message = lines.strip_prefix("error: ").unwrap_or_default().trim_end();
        assert!(!message.is_empty() && message.lines().count() == 1, "not one error message: {self:#?}");
        for trace in ["panicked at", "RUST_BACKTRACE", "stack backtrace"] {
            assert!(!message.contains(trace), "{self:#?}");
        }
        let mut parts: Vec<&str> = message.split(": ").collect();
        parts.sort_unstable();
        assert!(parts.windows(2).all(|pair| pair[0] != pair[1]), "repeated text: {self:#?}");
        message.to_owned()
    }
}

/// The path of the program. It is built with libtorch if these tests are (feature `torch`), otherwise without.
pub fn path() -> &'static Path {
    static PATH: OnceLock<PathBuf> = OnceLock::new();
    let target: &[&str] =
        if cfg!(feature = "torch") { &["-p", "ddl-cli", "--features", "torch"] } else { &["-p", "ddl-cli"] };
    PATH.get_or_init(|| {
        let path = built(Path::new("ddl"), target);
        if is_with_torch(&path) != cfg!(feature = "torch") {
            build(target);
        }
        path
    })
}

/// A program of the profile of this test, by its path below the build folder, such as `examples/draw_forecast`. It is
/// built first if it is missing or older than its sources; `target` are the arguments of cargo for it.
pub fn built(place: &Path, target: &[&str]) -> PathBuf {
    let mut path = profile_folder().join(place).into_os_string();
    path.push(std::env::consts::EXE_SUFFIX);
    let path = PathBuf::from(path);
    let crates = Path::new(env!("CARGO_MANIFEST_DIR")).join("../crates");
    let others = ["tests", "benches", "examples"];
    let others = &others[..if place.starts_with("examples") { 2 } else { 3 }];
    if modified(&path).is_none_or(|time| newest(&crates, others) > Some(time)) {
        build(target);
    }
    path
}

/// Cargo puts tests into `deps`, below the programs of the same profile.
fn profile_folder() -> PathBuf {
    let test = std::env::current_exe().expect("a running test has a path");
    let profile = test.ancestors().find(|folder| folder.ends_with("deps")).and_then(Path::parent);
    profile.expect("cargo built this test").to_path_buf()
}

fn build(target: &[&str]) {
    let folder = profile_folder();
    let profile = folder.file_name().unwrap_or_default();
    let is_debug = profile == "debug";
    let mut cargo = Command::new(std::env::var_os("CARGO").unwrap_or("cargo".into()));
    cargo
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .arg("build")
        .args(target)
        .arg("--profile")
        .arg(if is_debug { OsStr::new("dev") } else { profile })
        .arg("--target-dir")
        .arg(folder.parent().unwrap_or(&folder));
    let status = cargo.status().expect("cargo can be started");
    assert!(status.success(), "{cargo:?}: {status}");
}

/// What a program without libtorch says of everything that needs it.
pub const WITHOUT_LIBTORCH: &str = "needs libtorch, and this program is built without it";

fn is_with_torch(program: &Path) -> bool {
    let info = Command::new(program).args(["info", "--json"]).output().expect("the program can be started").stdout;
    !String::from_utf8_lossy(&info).contains(WITHOUT_LIBTORCH)
}

/// When a source was last changed, except folders of these names. Markdown pages do not affect a program.
fn newest(folder: &Path, others: &[&str]) -> Option<SystemTime> {
    let entries = std::fs::read_dir(folder).ok()?.flatten();
    let times = entries.filter_map(|entry| {
        let (path, name) = (entry.path(), entry.file_name());
        if path.is_dir() {
            // Nothing is built from the Python package, whose tests leave caches there.
            let is_other = others.iter().any(|other| name == *other)
                || name == "ddl-python"
                || name == "ddl-star" && !cfg!(feature = "torch");
            return if is_other { None } else { newest(&path, others) };
        }
        let is_page = path.extension() == Some(OsStr::new("md"));
        if is_page { None } else { modified(&path) }
    });
    times.max()
}

fn modified(path: &Path) -> Option<SystemTime> {
    path.metadata().ok()?.modified().ok()
}
