//! The guide as mdBook gets it: pages of the repository brought in whole, and links that lead somewhere in the site.
//!
//! A page of `docs/guide/src` may hold the line `{{#include ../../protocols.md}}`. In the repository its links are
//! relative to where the included file lies; here each is changed to the page of the guide, of the crates' interface or
//! the copied file that it means.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::fs;
use std::path::{Component, Path, PathBuf};

use anyhow::{Context, Result, bail};

use super::api::{self, Library};
use super::links;
use crate::whole_file;
use crate::workspace::Workspace;

/// Where the guide lies in the repository.
pub(crate) const GUIDE: &str = "docs/guide";
const INCLUDE: &str = "{{#include ";
/// Where files that are no pages are copied to.
const FILES: &str = "files";

/// Puts the guide together in the folder `stage`, to be rendered from there.
///
/// Returns the files of the repository that are shown whole, each with the page that shows it.
pub(super) fn stage(
    workspace: &Workspace,
    stage: &Path,
    libraries: &[Library],
) -> Result<BTreeMap<PathBuf, String>> {
    let guide = Guide::read(workspace.root(), libraries)?;
    let from = workspace.path(GUIDE);
    for name in ["book.toml", "theme"] {
        let (from, to) = (from.join(name), stage.join(name));
        if from.is_dir() {
            api::copy(&from, &to)?;
        } else {
            fs::copy(&from, &to).with_context(|| format!("{} cannot be copied", from.display()))?;
        }
    }
    let mut copied = Vec::new();
    for page in guide.pages.keys() {
        let text = guide.assembled(page, &mut copied)?;
        whole_file::write(&stage.join("src").join(page), text.as_bytes())?;
    }
    for file in copied {
        let to = stage.join("src").join(FILES).join(&file);
        let parent = to.parent().context("a file needs a folder")?;
        fs::create_dir_all(parent)
            .and_then(|()| fs::copy(workspace.root().join(&file), &to))
            .with_context(|| format!("{} cannot be copied", file.display()))?;
    }
    Ok(guide.shown)
}

/// The pages, and which file of the repository each brings in.
struct Guide<'a> {
    root: &'a Path,
    /// Name of a page and its text; all lie in one folder.
    pages: BTreeMap<String, String>,
    /// A file of the repository, and the page that shows the whole of it.
    shown: BTreeMap<PathBuf, String>,
    libraries: &'a [Library],
}

impl<'a> Guide<'a> {
    fn read(root: &'a Path, libraries: &'a [Library]) -> Result<Self> {
        let source = root.join(GUIDE).join("src");
        let mut guide = Self {
            root,
            pages: BTreeMap::new(),
            shown: BTreeMap::new(),
            libraries,
        };
        let entries = fs::read_dir(&source)
            .with_context(|| format!("{} cannot be read", source.display()))?;
        for entry in entries {
            let path = entry.context("the guide cannot be read")?.path();
            let name = path.file_name().unwrap_or_default().to_string_lossy();
            if path.extension().is_some_and(|extension| extension == "md") {
                guide.pages.insert(name.into_owned(), text_of(&path)?);
            }
        }
        let summary = guide
            .pages
            .get("SUMMARY.md")
            .context("the guide has no SUMMARY.md")?;
        let listed = |page: &str| summary.contains(&format!("]({page})"));
        for (page, text) in &guide.pages {
            if page != "SUMMARY.md" && !listed(page) {
                bail!("{GUIDE}/src/SUMMARY.md does not list {page}");
            }
            for file in text
                .lines()
                .filter_map(included)
                .filter(|file| is_markdown(file))
            {
                let file = joined(&source_folder(), file)
                    .with_context(|| format!("{page} brings in {file}, which is outside"))?;
                if let Some(other) = guide.shown.insert(file.clone(), page.clone()) {
                    bail!("{} is brought in by {other} and by {page}", file.display());
                }
            }
        }
        Ok(guide)
    }

    /// A page with what it brings in, every link changed; files it refers to are added to `copied`.
    fn assembled(&self, page: &str, copied: &mut Vec<PathBuf>) -> Result<String> {
        let text = &self.pages[page];
        let mut whole = String::new();
        // The text between two includes, whose links are relative to the page itself.
        let mut own = String::new();
        let folder = source_folder();
        for line in text.split_inclusive('\n') {
            let Some(file) = included(line) else {
                own.push_str(line);
                continue;
            };
            whole += &self.relinked(&std::mem::take(&mut own), &folder, page, copied)?;
            let (path, part) = file
                .split_once(':')
                .map_or((file, ""), |(path, part)| (path, part));
            let repository = joined(&folder, path)
                .with_context(|| format!("{page} brings in {file}, which is outside"))?;
            let full = self.root.join(&repository);
            if is_markdown(path) {
                let beside = repository.parent().unwrap_or(Path::new("")).to_path_buf();
                whole += &self.relinked(&text_of(&full)?, &beside, page, copied)?;
            } else if full.is_file() {
                // mdBook finds the part; it renders in another folder, so the path becomes a whole one.
                let part = if part.is_empty() {
                    String::new()
                } else {
                    format!(":{part}")
                };
                let _ = writeln!(whole, "{INCLUDE}{}{part}}}}}", full.display()); // writing to a string cannot fail
            } else {
                bail!("{page} brings in {file}, which does not exist");
            }
        }
        whole += &self.relinked(&own, &folder, page, copied)?;
        Ok(whole)
    }

    fn relinked(
        &self,
        text: &str,
        folder: &Path,
        page: &str,
        copied: &mut Vec<PathBuf>,
    ) -> Result<String> {
        links::rewrite(text, |target| {
            self.target(target, folder, copied)
                .with_context(|| format!("{GUIDE}/src/{page}: the link to {target}"))
        })
    }

    /// Where a link of a file in `folder` leads to within the site.
    fn target(&self, target: &str, folder: &Path, copied: &mut Vec<PathBuf>) -> Result<String> {
        let (path, anchor) = target
            .find('#')
            .map_or((target, ""), |at| target.split_at(at));
        if path.is_empty() || path.contains(':') {
            return Ok(target.to_owned()); // on the same page, or an address
        }
        let file = joined(folder, path).context("leads out of the repository")?;
        if let Some(page) = self.shown.get(&file) {
            return Ok(format!("{page}{anchor}"));
        }
        if let Ok(page) = file.strip_prefix(source_folder()) {
            let name = page.to_string_lossy();
            if self.pages.contains_key(&*name) {
                return Ok(format!("{name}{anchor}"));
            }
        }
        if let Some(found) = self.interface(&file) {
            return Ok(format!("../api/{found}{anchor}"));
        }
        let full = self.root.join(&file);
        if !full.is_file() {
            bail!("there is no file {}", file.display());
        }
        if is_markdown(path) {
            bail!(
                "bring {} in as a page of the guide, or do not link to it",
                file.display()
            );
        }
        let shown = format!("{FILES}/{}", slashes(&file));
        if !copied.contains(&file) {
            copied.push(file);
        }
        Ok(format!("{shown}{anchor}"))
    }

    /// The page of rustdoc for the folder, the README or a source file of a library crate.
    fn interface(&self, file: &Path) -> Option<String> {
        let inside = file.strip_prefix("crates").ok()?;
        let package = inside.iter().next()?.to_str()?;
        let library = self
            .libraries
            .iter()
            .find(|library| library.package == package)?;
        let module = library.module();
        let rest = slashes(inside.strip_prefix(package).ok()?);
        match rest.as_str() {
            "" | "README.md" => Some(format!("{module}/index.html")),
            source => {
                let source = source.strip_prefix("src/").filter(|name| {
                    Path::new(name)
                        .extension()
                        .is_some_and(|extension| extension == "rs")
                })?;
                self.root
                    .join(file)
                    .is_file()
                    .then(|| format!("src/{module}/{source}.html"))
            }
        }
    }
}

fn source_folder() -> PathBuf {
    Path::new(GUIDE).join("src")
}

fn is_markdown(path: &str) -> bool {
    Path::new(path)
        .extension()
        .is_some_and(|extension| extension == "md")
}

/// The file that a line brings in.
fn included(line: &str) -> Option<&str> {
    line.trim()
        .strip_prefix(INCLUDE)?
        .strip_suffix("}}")
        .map(str::trim)
}

fn text_of(path: &Path) -> Result<String> {
    fs::read_to_string(path).with_context(|| format!("{} cannot be read", path.display()))
}

/// `folder/relative` without `.` and `..`; nothing when it leads out of the repository.
fn joined(folder: &Path, relative: &str) -> Option<PathBuf> {
    let mut path = PathBuf::new();
    for part in folder.join(relative).components() {
        match part {
            Component::Normal(name) => path.push(name),
            Component::CurDir => {}
            Component::ParentDir => {
                if !path.pop() {
                    return None;
                }
            }
            Component::RootDir | Component::Prefix(_) => return None,
        }
    }
    Some(path)
}

fn slashes(path: &Path) -> String {
    let parts: Vec<_> = path.iter().map(|part| part.to_string_lossy()).collect();
    parts.join("/")
}

#[cfg(test)]
#[path = "guide_tests.rs"]
mod tests;
