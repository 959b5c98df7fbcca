//! Output to standard output, or to a file that is replaced as a whole.

use anyhow::Context as _;
use std::io::Write as _;
use std::path::Path;

/// The file of an output; `None` for standard output, which `-` names too.
pub(crate) fn file_of(path: Option<&Path>) -> Option<&Path> {
    path.filter(|path| *path != Path::new("-"))
}

/// Writes a whole output: to standard output, or to a file under a temporary name that is renamed.
pub(crate) fn write_output(path: Option<&Path>, text: &str) -> anyhow::Result<()> {
    match file_of(path) {
        // A device or a pipe cannot be replaced.
        Some(path) if path.exists() && !path.is_file() => {
            std::fs::write(path, text).with_context(|| format!("cannot write to {}", path.display()))
        }
        Some(path) => Ok(ddl::write_atomically(path, text.as_bytes())?),
        None => print(text),
    }
}

pub(crate) fn print(text: &str) -> anyhow::Result<()> {
    let mut out = std::io::stdout().lock();
    out.write_all(text.as_bytes())
        .and_then(|()| out.flush())
        .context("cannot write to standard output")
}

/// A coordinate in tables, rounded to 0.1 mm; or a time, rounded to 0.1 ms.
pub(crate) fn table_metres(metres: f64) -> f64 {
    // no `-0`
    (1e4 * metres).round() / 1e4 + 0.0
}

/// A share in tables, rounded to 3 significant digits.
pub(crate) fn table_share(share: f64) -> f64 {
    // cannot fail: a formatted number parses
    format!("{share:.2e}").parse().unwrap_or(share)
}

pub(crate) fn shell_word(path: &Path) -> String {
    let path = path.display().to_string();
    // Quoting fails only for a zero byte, which no path contains.
    shlex::try_quote(&path).map_or_else(|_| path.clone(), Into::into)
}

pub(crate) fn print_json(facts: &impl serde::Serialize) -> anyhow::Result<()> {
    print(&(serde_json::to_string_pretty(facts)? + "\n"))
}
