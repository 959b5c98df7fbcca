//! The documentation site: the guide (`docs/`, by mdBook) and the interface of every crate (by rustdoc), in one folder.
//! It can be opened from the file system or served as it is; it loads nothing from a network.

mod api;
mod check;
mod outward;
mod page;

use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use anyhow::{Context, Result, bail};

use crate::cargo_tool::CargoTool;
use crate::whole_file;
use crate::workspace::Workspace;
use api::Library;

/// The version that the theme was written for.
const MDBOOK: CargoTool = CargoTool {
    name: "mdbook",
    version: "0.5.4",
    options: &["--no-default-features", "--features", "search"],
    version_call: &["--version"],
};
/// The book, whose `src` is this folder.
const BOOK: &str = "docs";
const LANDING: &str = include_str!("site/landing.html");
/// Place of the list of crates on the first page.
const CRATES: &str = "<!-- crates -->";
/// rustdoc's pages link to a list of crates, which is on the first page of the site.
const ONWARD: &str = "<!doctype html>\n<html lang=\"en\">\n<meta charset=\"utf-8\">\n<title>Crates</title>\n\
    <meta http-equiv=\"refresh\" content=\"0;URL=../index.html\">\n\
    <a href=\"../index.html#crates\">Crates</a>\n</html>\n";

pub(crate) fn build(workspace: &Workspace) -> Result<PathBuf> {
    let mdbook = MDBOOK.ensure(workspace)?;
    let metadata = workspace.metadata()?;
    let target = metadata["target_directory"].as_str();
    let target = Path::new(target.context("`cargo metadata` names no target folder")?);
    let site = target.join("site");
    remove(&site)?;
    let libraries = api::libraries(&metadata);
    let book = target.join("book");
    remove(&book)?;
    outward::copy_book(&workspace.path(BOOK), &book, &libraries, &site)?;
    render(&mdbook, &book, &site.join("guide"))?;
    api::build(workspace, &libraries, &target.join("doc"), &site.join("api"))?;
    whole_file::write(&site.join("index.html"), landing(&libraries).as_bytes())?;
    whole_file::write(&site.join("api/index.html"), ONWARD.as_bytes())?;
    let mut checked = check::check(&site)?;
    checked
        .faults
        .extend(unlisted(&workspace.path(BOOK), &site.join("guide"))?);
    if !checked.faults.is_empty() {
        let shown: Vec<&str> = checked.faults.iter().take(40).map(String::as_str).collect();
        bail!("{} faults on the site:\n{}", checked.faults.len(), shown.join("\n"));
    }
    println!(
        "{} pages, {} links inside the site, all valid",
        checked.pages, checked.links
    );
    Ok(site.join("index.html"))
}

fn remove(folder: &Path) -> Result<()> {
    if folder.exists() {
        fs::remove_dir_all(folder).with_context(|| format!("{} cannot be removed", folder.display()))?;
    }
    Ok(())
}

/// Renders the book; every warning of mdBook is an error.
fn render(mdbook: &Path, book: &Path, out: &Path) -> Result<()> {
    let output = Command::new(mdbook)
        .arg("build")
        .arg("--dest-dir")
        .arg(out)
        .arg(book)
        .stdin(Stdio::null())
        .output()
        .with_context(|| format!("{} cannot be started", mdbook.display()))?;
    let said = String::from_utf8_lossy(&output.stderr);
    // mdBook continues after most faults and only logs them.
    if !output.status.success() || said.contains("WARN") || said.contains("ERROR") {
        bail!("mdbook does not accept the pages of {BOOK}:\n{}", said.trim());
    }
    Ok(())
}

/// Pages of the book that `SUMMARY.md` does not list; mdBook leaves them out silently.
fn unlisted(book: &Path, rendered: &Path) -> Result<Vec<String>> {
    let mut found = Vec::new();
    for file in check::files_below(book)? {
        let page = file.strip_prefix(book).unwrap_or(&file);
        if page.extension().is_some_and(|extension| extension == "md")
            && page != Path::new("SUMMARY.md")
            && !rendered.join(page).with_extension("html").is_file()
        {
            found.push(format!("{BOOK}/SUMMARY.md does not list {}", page.display()));
        }
    }
    Ok(found)
}

fn landing(libraries: &[Library]) -> String {
    let mut rows = String::new();
    for Library {
        module,
        package,
        description,
        ..
    } in libraries
    {
        // Writing to a string cannot fail.
        let _ = writeln!(
            rows,
            "<dt><a href=\"api/{module}/index.html\">{package}</a></dt><dd>{description}</dd>"
        );
    }
    LANDING.replace(CRATES, rows.trim_end())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_page_missing_in_the_summary_is_reported() {
        let folder = tempfile::tempdir().unwrap();
        let (book, out) = (folder.path().join("docs"), folder.path().join("out"));
        for file in [
            book.join("SUMMARY.md"),
            book.join("a.md"),
            book.join("lost.md"),
            out.join("a.html"),
        ] {
            whole_file::write(&file, b"").unwrap();
        }
        assert_eq!(
            unlisted(&book, &out).unwrap(),
            ["docs/SUMMARY.md does not list lost.md"]
        );
    }
}
