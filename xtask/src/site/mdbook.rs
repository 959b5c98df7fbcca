//! mdBook, which makes the guide's pages.

use std::path::Path;
use std::process::{Command, Stdio};

use anyhow::{Context, Result, bail};

use crate::cargo_tool::CargoTool;

/// The version that the theme was written for.
pub(super) const TOOL: CargoTool = CargoTool {
    name: "mdbook",
    version: "0.5.4",
    options: &["--no-default-features", "--features", "search"],
};

/// Renders the book in `book` into `out`; whatever mdBook complains of is an error.
pub(super) fn render(program: &Path, book: &Path, out: &Path) -> Result<()> {
    let output = Command::new(program)
        .arg("build")
        .arg("--dest-dir")
        .arg(out)
        .arg(book)
        .stdin(Stdio::null())
        .output()
        .with_context(|| format!("{} cannot be started", program.display()))?;
    let said = String::from_utf8_lossy(&output.stderr);
    if !output.status.success() || complains(&said) {
        bail!("mdbook does not accept the guide:\n{}", said.trim());
    }
    Ok(())
}

/// mdBook goes on where an included file is missing, and says so in its log.
fn complains(log: &str) -> bool {
    log.lines()
        .any(|line| line.contains("WARN") || line.contains("ERROR"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_warning_in_the_log_is_seen() {
        assert!(!complains(
            " INFO Book building has started\n INFO Running the html backend\n"
        ));
        assert!(complains(
            "ERROR Error updating \"{{#include nowhere}}\", cannot read\n"
        ));
        assert!(complains(" WARN unclosed HTML tag\n"));
    }
}
