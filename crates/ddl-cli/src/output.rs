//! Output to standard output, or to a file that is replaced as a whole.

use anyhow::Context as _;
use ddl::data::write_atomically_with;
use std::fs::File;
use std::io::Write as _;
use std::path::Path;

/// The file of an output; `None` for standard output, which `-` names too. A log that `/dev/stdout` leads to is kept.
pub(crate) fn file_of(path: Option<&Path>) -> Option<&Path> {
    path.filter(|path| !["-", "/dev/stdout"].map(Path::new).contains(path))
}

/// Writes a whole output: to standard output, or to a file under a temporary name that is renamed.
pub(crate) fn write_output(path: Option<&Path>, text: &str) -> anyhow::Result<()> {
    write_parts(path, std::iter::once(Ok(text)))
}

/// As [`write_output`], for an output that is too large to be held as a whole.
pub(crate) fn write_parts<T: AsRef<str>>(
    path: Option<&Path>,
    parts: impl Iterator<Item = anyhow::Result<T>>,
) -> anyhow::Result<()> {
    let Some(path) = file_of(path) else {
        return parts.into_iter().try_for_each(|part| print(part?.as_ref()));
    };
    write_file(path, |file| {
        parts.into_iter().try_for_each(|part| {
            file.write_all(part?.as_ref().as_bytes()).with_context(|| format!("cannot write to {}", path.display()))
        })
    })
}

/// Writes a file under a temporary name that is renamed.
pub(crate) fn write_file(path: &Path, write: impl FnOnce(&mut File) -> anyhow::Result<()>) -> anyhow::Result<()> {
    let unwritable = || format!("cannot write to {}", path.display());
    // A device or a pipe cannot be replaced, and what is open already not either when it leads to a file.
    let open = ["/dev/fd", "/dev/stdout", "/dev/stderr", "/proc"];
    if path.exists() && (!path.is_file() || open.iter().any(|open| path.starts_with(open))) {
        let file = File::options().append(true).open(path);
        return write(&mut file.with_context(unwritable)?);
    }
    let mut failed = None;
    let written: std::io::Result<()> = write_atomically_with(path, |file| {
        write(file).map_err(|error| {
            failed = Some(error);
            std::io::ErrorKind::Other.into()
        })
    });
    // What made no part is no fault of the file.
    failed.map_or_else(|| written.with_context(unwritable), Err)
}

pub(crate) fn print(text: &str) -> anyhow::Result<()> {
    let mut out = std::io::stdout().lock();
    out.write_all(text.as_bytes()).and_then(|()| out.flush()).context("cannot write to standard output")
}

pub(crate) fn shell_word(path: &Path) -> String {
    let path = path.display().to_string();
    // Quoting fails only for a zero byte, which no path contains.
    shlex::try_quote(&path).map_or_else(|_| path.clone(), Into::into)
}

pub(crate) fn print_json(facts: &impl serde::Serialize) -> anyhow::Result<()> {
    print(&(serde_json::to_string_pretty(facts)? + "\n"))
}

/// Where the answers to a stream go.
pub(crate) struct StreamOutput {
    /// `None` for standard output.
    file: Option<File>,
    /// Whether a forecast was written. The first forecast replaces an existing file; an input without forecasts does
    /// not.
    begun: bool,
}

impl StreamOutput {
    /// Opens the output before the first forecast, so that an error shows at once.
    pub(crate) fn open(path: Option<&Path>) -> anyhow::Result<Self> {
        let mut options = File::options();
        let options = options.write(true).create(true).truncate(false);
        let open = |path: &Path| options.open(path).with_context(|| format!("cannot write {}", path.display()));
        Ok(Self { file: file_of(path).map(open).transpose()?, begun: false })
    }

    pub(crate) fn write(&mut self, text: &str) -> std::io::Result<()> {
        let Some(file) = &mut self.file else {
            let mut out = std::io::stdout().lock();
            out.write_all(text.as_bytes())?;
            return out.flush();
        };
        // A device or a pipe has no earlier content.
        if !self.begun && file.metadata()?.is_file() {
            file.set_len(0)?;
        }
        self.begun = true;
        file.write_all(text.as_bytes())
    }
}
