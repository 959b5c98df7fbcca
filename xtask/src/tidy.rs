//! Rules that no other tool checks: names and lengths of files, columns, words, links between files, and inherited
//! lints. Recordings and paths of a developer's machine must not be tracked.

mod columns;
mod links;
mod sizes;
mod words;

use std::path::Path;

use anyhow::{Context, Result, bail};

use crate::data::{Manifest, RECORDED};
use crate::digest::measure;
use crate::workspace::Workspace;
use sizes::Sizes;

/// Length (lines) above which a file should probably be split.
const SOFT_LIMIT: usize = 300;
const HARD_LIMIT: usize = 500;
/// Names that do not describe the content.
const EMPTY_NAMES: [&str; 9] = [
    "utils", "util", "common", "helpers", "helper", "misc", "stuff", "tools", "shared",
];
/// The content of `datasets`: descriptions, and a simulated recording that a test generates again.
const DESCRIPTIONS: [&str; 4] = ["README.md", "manifest.toml", "folds.json", "sample.csv"];
// Spelled in pieces, so that this file does not find itself.
const HOME_FOLDERS: [&str; 3] = [concat!("/ho", "me/"), concat!("/ro", "ot/"), concat!("/Use", "rs/")];

#[derive(Debug, Default)]
struct Findings {
    faults: Vec<String>,
    notes: Vec<String>,
}

pub(crate) fn run(workspace: &Workspace) -> Result<()> {
    let Findings { faults, notes } = check(workspace)?;
    for note in &notes {
        println!("note: {note}");
    }
    for fault in &faults {
        println!("fault: {fault}");
    }
    if !faults.is_empty() {
        bail!("tidy: {} faults (above)", faults.len());
    }
    println!("tidy: no faults, {} notes", notes.len());
    Ok(())
}

fn check(workspace: &Workspace) -> Result<Findings> {
    let manifest = Manifest::load(workspace)?;
    let recordings: Vec<(&str, &str)> = RECORDED
        .into_iter()
        .flat_map(|convention| manifest.entry(convention))
        .flat_map(|entry| &entry.files)
        .map(|file| (file.name.as_str(), file.sha256.as_str()))
        .collect();
    let files = workspace.files()?;
    let mut findings = Findings::default();
    let mut sizes = Sizes::default();
    for file in &files {
        let path = workspace.path(&file.to_string_lossy());
        if !path.is_file() {
            continue; // a link to a folder
        }
        let (sha256, _) = measure(&path)?;
        let named = name_fault(file).or_else(|| recording_fault(file, &sha256, &recordings));
        let bytes = std::fs::read(&path).with_context(|| format!("{} cannot be read", file.display()))?;
        let said = named.into_iter().map(|what| format!("{}: {what}", file.display()));
        findings.faults.extend(said);
        // Only text files have lines to check.
        if let Ok(text) = std::str::from_utf8(&bytes) {
            check_text(file, text, &mut findings);
            findings.faults.extend(links::faults(file, text, &files));
            findings.faults.extend(columns::faults(file, text));
            findings.faults.extend(words::faults(file, text));
            findings.faults.extend(sizes.fault(file, text));
        }
    }
    findings.faults.extend(sizes.fault_of_all());
    Ok(findings)
}

fn name_fault(file: &Path) -> Option<String> {
    let folders = file.parent().into_iter().flat_map(Path::iter);
    let mut names = folders.chain(file.file_stem()).filter_map(|name| name.to_str());
    let name = names.find(|name| EMPTY_NAMES.contains(name))?;
    Some(format!("{name:?} is not descriptive: name the file after its concept"))
}

/// The terms of the recordings do not clearly allow redistribution, so none may be tracked under any name.
fn recording_fault(file: &Path, sha256: &str, recordings: &[(&str, &str)]) -> Option<String> {
    let name = file.file_name()?.to_str()?;
    let is_recording = |&&(recording, pinned): &&(&str, &str)| recording == name || pinned == sha256;
    if let Some((recording, _)) = recordings.iter().find(is_recording) {
        return Some(format!(
            "this is the recording {recording}; remove it, no recording may be committed"
        ));
    }
    let is_data = file.starts_with("datasets") && !DESCRIPTIONS.contains(&name);
    is_data.then(|| "datasets/ holds descriptions and the simulated sample, no data".to_owned())
}

fn check_text(file: &Path, text: &str, findings: &mut Findings) {
    let name = file.display();
    let lines = text.lines().count();
    if file.extension().is_some_and(|extension| extension == "rs") && lines > SOFT_LIMIT {
        if lines > HARD_LIMIT {
            findings
                .faults
                .push(format!("{name}: {lines} lines, more than {HARD_LIMIT}: split it"));
        } else {
            findings.notes.push(format!(
                "{name}: {lines} lines, more than {SOFT_LIMIT}: consider splitting it"
            ));
        }
    }
    if file.file_name() == Some("Cargo.toml".as_ref())
        && text.contains(".workspace = true")
        && !text.contains("[lints]\nworkspace = true")
    {
        findings.faults.push(format!("{name}: add `[lints] workspace = true`"));
    }
    for (number, line) in (1..).zip(text.lines()) {
        if HOME_FOLDERS.iter().any(|folder| names_home(line, folder)) {
            findings
                .faults
                .push(format!("{name}:{number}: a path in a home folder; remove it"));
        }
    }
}

/// Whether a line names a folder below a home folder, as opposed to an address or a longer path that contains the same
/// word.
fn names_home(line: &str, folder: &str) -> bool {
    line.match_indices(folder).any(|(at, _)| {
        let before = line[..at].chars().next_back();
        let after = line[at + folder.len()..].chars().next();
        let begins = before.is_none_or(|c| !c.is_alphanumeric() && !"/.-_}~*".contains(c));
        begins && after.is_some_and(|c| c.is_alphanumeric() || c == '.')
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(file: &str, text: &str) -> Findings {
        let mut findings = Findings::default();
        check_text(Path::new(file), text, &mut findings);
        findings
    }

    #[test]
    fn names_that_are_not_descriptive_are_found_in_files_and_folders() {
        for file in ["crates/a/src/utils.rs", "helpers.py", "docs/misc/page.md"] {
            assert!(name_fault(Path::new(file)).is_some(), "{file}");
        }
        for file in ["crates/a/src/window.rs", "src/utilisation.rs", "common_law.rs"] {
            assert!(name_fault(Path::new(file)).is_none(), "{file}");
        }
    }

    #[test]
    fn a_recording_is_found_by_place_by_name_and_by_contents() {
        let fault = |file: &str, sha256| recording_fault(Path::new(file), sha256, &[("eth.csv", "abc")]);
        assert_eq!(fault("datasets/folds.json", "x"), None);
        assert!(fault("datasets/new.csv", "x").unwrap().contains("no data"));
        for (file, sha256) in [("eth.csv", "x"), ("renamed.txt", "abc")] {
            assert!(fault(file, sha256).unwrap().contains("the recording eth.csv"));
        }
    }

    #[test]
    fn length_is_a_note_and_then_a_fault() {
        let counts = |file, lines| {
            let findings = found(file, &"//\n".repeat(lines));
            (findings.notes.len(), findings.faults.len())
        };
        assert_eq!(counts("a.rs", SOFT_LIMIT), (0, 0));
        assert_eq!(counts("a.rs", SOFT_LIMIT + 1), (1, 0));
        assert_eq!(counts("a.rs", HARD_LIMIT + 1), (0, 1));
        assert_eq!(counts("table.md", 9999), (0, 0));
    }

    #[test]
    fn lints_are_inherited() {
        let manifest = "[package]\nversion.workspace = true\n";
        assert_eq!(found("crates/a/Cargo.toml", manifest).faults.len(), 1);
        let whole = format!("{manifest}\n[lints]\nworkspace = true\n");
        assert!(found("crates/a/Cargo.toml", &whole).faults.is_empty());
    }

    #[test]
    fn home_folders_are_found_and_addresses_are_not() {
        for folder in HOME_FOLDERS {
            assert_eq!(
                found("a.md", &format!("\nsee {folder}someone/x")).faults.len(),
                1,
                "{folder}"
            );
            for text in ["https://host{}page", "a{}b", "{} alone"] {
                assert!(found("a.md", &text.replace("{}", folder)).faults.is_empty(), "{text}");
            }
        }
    }
}
