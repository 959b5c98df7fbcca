//! Links and includes of the book that lead to other files of the repository. On the site, the README of a crate is the
//! first page of its interface; all other files are in the folder `files`.

use std::fs;
use std::path::Path;

use anyhow::{Context, Result, bail};

use super::api::Library;
use super::check;

const FILES: &str = "files";
/// mdBook's directive that includes a file. mdBook would look for the file beside the copy of the book.
const INCLUDE: &str = "{{#include ../";

/// Copies the book to `to`, with its outward links changed, and copies their targets to the site.
pub(super) fn copy_book(book: &Path, to: &Path, libraries: &[Library], site: &Path) -> Result<()> {
    let root = book.parent().context("the book lies in the workspace")?;
    for file in check::files_below(book)? {
        let within = file.strip_prefix(book).unwrap_or(&file);
        let copy = to.join(within);
        if within.extension().is_some_and(|extension| extension == "md") {
            let text = fs::read_to_string(&file).with_context(|| format!("{} cannot be read", file.display()))?;
            let (text, linked) = changed(&included(&text, root)?, libraries);
            crate::whole_file::write(&copy, text.as_bytes())?;
            for (path, name) in linked {
                let linked = root.join(&path);
                if !linked.is_file() {
                    bail!("{}: ../{path} is not a file", file.display());
                }
                copy_file(&linked, &site.join(FILES).join(name))?;
            }
        } else {
            copy_file(&file, &copy)?;
        }
    }
    Ok(())
}

/// A page with the text of the files that it includes.
fn included(page: &str, root: &Path) -> Result<String> {
    let mut parts = page.split(INCLUDE);
    let mut text = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        let (path, rest) = part.split_once("}}").context("an include has no end")?;
        let file = root.join(path);
        let file = fs::read_to_string(&file).with_context(|| format!("{} cannot be read", file.display()))?;
        text.push_str(file.trim_end());
        text.push_str(rest);
    }
    Ok(text)
}

fn copy_file(from: &Path, to: &Path) -> Result<()> {
    let failed = || format!("{} cannot be copied to {}", from.display(), to.display());
    let folder = to.parent().with_context(failed)?;
    fs::create_dir_all(folder).with_context(failed)?;
    fs::copy(from, to).with_context(failed)?;
    Ok(())
}

/// A page with its links changed, and the files to copy: their paths and their names in the folder.
fn changed(page: &str, libraries: &[Library]) -> (String, Vec<(String, String)>) {
    let mut parts = page.split("](../");
    let mut text = parts.next().unwrap_or_default().to_owned();
    let mut files = Vec::new();
    for part in parts {
        let (target, rest) = part.split_at(part.find(')').unwrap_or(part.len()));
        let (path, place) = target.split_at(target.find('#').unwrap_or(target.len()));
        let library = path
            .strip_prefix("crates/")
            .and_then(|path| path.strip_suffix("/README.md"))
            .and_then(|folder| libraries.iter().find(|library| library.folder == folder));
        let target = if let Some(library) = library {
            format!("api/{}/index.html{place}", library.module)
        } else {
            // mdBook would take a `.md` for one of its pages.
            let is_page = Path::new(path).extension().is_some_and(|end| end == "md");
            let name = format!("{path}{}", if is_page { ".txt" } else { "" });
            files.push((path.to_owned(), name.clone()));
            format!("{FILES}/{name}")
        };
        text.push_str("](../");
        text.push_str(&target);
        text.push_str(rest);
    }
    (text, files)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn links_out_of_the_book_lead_to_the_interface_and_to_copies() {
        let library = Library {
            package: "ddl-forecast".to_owned(),
            module: "ddl".to_owned(),
            folder: "ddl".to_owned(),
            description: String::new(),
        };
        let page = "[a](../crates/ddl/README.md#x) [b](../LICENSE) [c](d.md) [e](../f.md#g).";
        let (text, files) = changed(page, &[library]);
        assert_eq!(
            text,
            "[a](../api/ddl/index.html#x) [b](../files/LICENSE) [c](d.md) [e](../files/f.md.txt)."
        );
        let copied: Vec<&str> = files.iter().map(|(_, name)| name.as_str()).collect();
        assert_eq!(copied, ["LICENSE", "f.md.txt"]);
    }

    #[test]
    fn included_files_are_part_of_the_page() {
        let folder = tempfile::tempdir().unwrap();
        crate::whole_file::write(&folder.path().join("a/b.md"), b"text\n").unwrap();
        let page = |path: &str| included(&format!("x {INCLUDE}{path}}}}} y\n"), folder.path());
        assert_eq!(page("a/b.md").unwrap(), "x text y\n");
        assert!(page("a/c.md").unwrap_err().to_string().contains("c.md"));
    }
}
