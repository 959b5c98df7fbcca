//! Rules of this repository that no other tool checks: recordings and paths of a developer's machine must not be
//! tracked; names, lengths and columns of files; sizes of pages.

use crate::cache::sha256;
use crate::recordings::{Manifest, RECORDED};
use crate::workspace::Workspace;
use anyhow::{Context, Result, ensure};
use std::path::Path;

/// Largest number of lines of a Rust file, and of columns of Rust and Markdown.
const LINES: usize = 500;
const COLUMNS: usize = 120;
/// Largest sizes in bytes: the README, that of a crate, the text of a page of `docs`, of all of these.
const README: usize = 7_000;
const CRATE_README: usize = 4_000;
const PAGE: usize = 10_000;
const ALL_PAGES: usize = 128_000;
/// Names that do not describe the content.
const EMPTY_NAMES: [&str; 6] = ["utils", "util", "common", "helpers", "helper", "misc"];
/// The content of `datasets`: descriptions, and a simulated recording that a test generates again.
const DESCRIPTIONS: [&str; 4] = ["README.md", "manifest.toml", "folds.json", "sample.csv"];
// Spelled in pieces, so that this file does not find itself.
const HOME_FOLDERS: [&str; 3] = [concat!("/ho", "me/"), concat!("/ro", "ot/"), concat!("/Use", "rs/")];

pub(crate) fn run(workspace: &Workspace) -> Result<()> {
    let manifest = Manifest::load(workspace)?;
    let recordings = RECORDED.iter().filter_map(|name| manifest.entry(name).ok()).flat_map(|entry| &entry.files);
    let recordings: Vec<_> = recordings.map(|file| [file.name.as_str(), file.sha256.as_str()]).collect();
    let summary = std::fs::read_to_string(workspace.path("docs/SUMMARY.md")).context("docs/SUMMARY.md")?;
    let mut faults = Vec::new();
    let mut pages = 0;
    for file in workspace.files()? {
        let path = workspace.root.join(&file);
        let bytes = std::fs::read(&path).with_context(|| format!("{} cannot be read", file.display()))?;
        let mut of_file = Vec::from_iter(recording_fault(&file, &sha256(&path)?, &recordings));
        // Only text files have lines to check.
        if let Ok(text) = std::str::from_utf8(&bytes) {
            of_file.extend(text_faults(&file, text));
            let is_package = file.starts_with("crates") && file.ends_with("Cargo.toml");
            if is_package && !text.contains("publish = false") {
                let needed = ["LICENSE-MIT", "LICENSE-APACHE", "README.md"];
                let missing = needed.iter().filter(|name| !path.with_file_name(name).is_file());
                of_file.extend(missing.map(|name| format!("the package lacks {name}")));
            }
            if is_page(&file) {
                pages += written(text);
                let name = file.file_name().unwrap_or_default().display();
                if !summary.contains(&format!("({name})")) && file != Path::new("docs/SUMMARY.md") {
                    of_file.push("docs/SUMMARY.md does not list it".to_owned());
                }
            }
        }
        faults.extend(of_file.iter().map(|fault| format!("{}: {fault}", file.display())));
    }
    if pages > ALL_PAGES {
        faults.push(format!("docs: {pages} bytes of pages; at most {ALL_PAGES}"));
    }
    ensure!(faults.is_empty(), "{} faults:\n{}", faults.len(), faults.join("\n"));
    Ok(())
}

/// The terms of the recordings do not clearly allow redistribution, so none may be tracked under any name.
fn recording_fault(file: &Path, sha256: &str, recordings: &[[&str; 2]]) -> Option<String> {
    let name = file.file_name()?.to_str()?;
    let mut recordings = recordings.iter();
    if let Some([recording, _]) = recordings.find(|recording| recording.contains(&name) || recording[1] == sha256) {
        return Some(format!("this is the recording {recording}: none may be committed"));
    }
    let is_data = file.starts_with("datasets") && !DESCRIPTIONS.contains(&name);
    is_data.then(|| "datasets/ holds descriptions and the simulated sample, no data".to_owned())
}

fn is_page(file: &Path) -> bool {
    file.starts_with("docs") && file.extension().is_some_and(|extension| extension == "md")
}

pub(crate) fn text_faults(file: &Path, text: &str) -> Vec<String> {
    let mut faults = Vec::new();
    let mut names = file.iter().chain(file.file_stem()).filter_map(|name| name.to_str());
    if let Some(name) = names.find(|name| EMPTY_NAMES.contains(name)) {
        faults.push(format!("{name:?} is not descriptive: name the file after its concept"));
    }
    let kind = file.extension().map_or("", |kind| kind.to_str().unwrap_or_default());
    let is_crate_page = file.starts_with("crates") && file.ends_with("README.md");
    let (size, limit, unit) = match file {
        _ if is_page(file) => (written(text), PAGE, "bytes"),
        _ if is_crate_page => (text.len(), CRATE_README, "bytes"),
        _ if file == Path::new("README.md") => (text.len(), README, "bytes"),
        _ if kind == "rs" => (text.lines().count(), LINES, "lines"),
        _ => (0, 0, ""),
    };
    if size > limit {
        faults.push(format!("{size} {unit}; at most {limit}"));
    }
    if is_crate_page && text.contains("](../") {
        faults.push("this page is read elsewhere, too: name files of other folders without a link".to_owned());
    }
    if kind == "toml" && text.contains("edition.workspace = true") && !text.contains("[lints]\nworkspace = true") {
        faults.push("the lints of the workspace are not inherited".to_owned());
    }
    // Where packages come from is the concern of each machine.
    let mut lines = text.lines().filter(|line| !line.starts_with('#'));
    if file.starts_with("xtask") && kind == "txt" && lines.any(|line| line.starts_with("--") || line.contains('/')) {
        faults.push("a list of packages has names, versions and sums alone: no option, no path".to_owned());
    }
    let mut is_code = false;
    for (number, line) in (1..).zip(text.lines()) {
        is_code ^= line.trim_start().starts_with("```");
        // Rows of tables, code blocks of pages and link targets may be longer.
        let is_row = line.trim_start_matches(['/', '!', ' ']).starts_with('|');
        let is_free = is_row || kind == "md" && is_code;
        let targets = line.split("](").skip(1).filter_map(|rest| rest.split_once(')'));
        let columns = line.chars().count() - targets.map(|(target, _)| target.chars().count()).sum::<usize>();
        if ["rs", "md"].contains(&kind) && !is_free && columns > COLUMNS {
            faults.push(format!("line {number} has more than {COLUMNS} columns"));
        }
        let mut words = line.split([' ', '"', '\'', '(', '=', '`', ',', '\\']);
        let is_at_home = |word: &str, home: &&str| word.len() > home.len() && word.starts_with(home);
        if words.any(|word| HOME_FOLDERS.iter().any(|home| is_at_home(word, home))) {
            faults.push(format!("line {number} has a path in a home folder"));
        }
    }
    faults
}

/// Bytes of a page without tables, which commands print, and without the output of shown commands, which a test
/// compares with the real output.
fn written(text: &str) -> usize {
    let mut is_console = false;
    let counted = text.lines().filter(|line| {
        if let Some(kind) = line.strip_prefix("```") {
            is_console = kind == "console";
        } else if is_console && !line.starts_with('$') {
            return false;
        }
        !line.starts_with('|')
    });
    counted.map(|line| line.len() + 1).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_fault_is_found_and_what_is_right_passes() {
        let long = "word ".repeat(30);
        let target = "x".repeat(120);
        let home = HOME_FOLDERS[0];
        for (file, text, fault) in [
            ("crates/a/src/utils.rs", String::new(), "not descriptive"),
            ("src/utilisation.rs", String::new(), ""),
            ("a.rs", "//\n".repeat(LINES + 1), "501 lines; at most 500"),
            ("a.rs", "//\n".repeat(LINES), ""),
            ("README.md", "x\n".repeat(README), "14000 bytes; at most 7000"),
            ("docs/a.md", "x\n".repeat(PAGE), "20000 bytes"),
            ("docs/a.svg", "x\n".repeat(PAGE), ""),
            ("crates/a/README.md", "x\n".repeat(CRATE_README), "8000 bytes"),
            ("crates/a/README.md", "[a](../b.md)".to_owned(), "without a link"),
            ("a.rs", format!("x\n{long}\n"), "line 2 has more than 120 columns"),
            ("a.rs", format!("    /// | {long} |\n"), ""),
            ("a.md", format!("{long}\n"), "line 1"),
            ("a.md", format!("| {long} |\n```text\n{long}\n```\n[a]({target})\n"), ""),
            ("a.toml", format!("{long}\n"), ""),
            ("a.toml", "edition.workspace = true\n".to_owned(), "not inherited"),
            ("xtask/a.txt", "--find-links a\n".to_owned(), "no option"),
            ("xtask/a.txt", "# a/b\na==1\n    --hash=sha256:0\n".to_owned(), ""),
            ("a.md", format!("see {home}someone/x"), "home folder"),
            ("a.md", format!("https://host{home}page, a{home}b"), ""),
        ] {
            let faults = text_faults(Path::new(file), &text);
            assert_eq!(faults.len(), usize::from(!fault.is_empty()), "{file}: {faults:?}");
            assert!(faults.iter().all(|found| found.contains(fault)), "{file}: {faults:?}");
        }
    }

    #[test]
    fn a_recording_is_found_by_place_by_name_and_by_contents() {
        let fault = |file: &str, sha256| recording_fault(Path::new(file), sha256, &[["eth.csv", "abc"]]);
        assert_eq!(fault("datasets/folds.json", "x"), None);
        assert!(fault("datasets/new.csv", "x").unwrap().contains("no data"));
        for (file, sha256) in [("eth.csv", "x"), ("renamed.txt", "abc")] {
            assert!(fault(file, sha256).unwrap().contains("the recording eth.csv"));
        }
    }

    #[test]
    fn tables_and_printed_output_do_not_count() {
        let page = "a\n```console\n$ ddl data\nan answer\n```\nb\n| table |\n```rust\nlet c = 1;\n```\n";
        assert_eq!(written(page), page.len() - "an answer\n| table |\n".len());
    }
}
