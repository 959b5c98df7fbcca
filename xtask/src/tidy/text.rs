//! What source files may say, and how long they may be.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result};

use super::Findings;

/// A file beyond this has probably outgrown its name.
const SOFT_LIMIT: usize = 300;
/// No file may be longer.
const HARD_LIMIT: usize = 500;

// Spelled in pieces, so that this file does not find itself.
const BARE_IGNORE: &str = concat!("#[", "ignore]");
const UNFINISHED: [&str; 2] = [concat!("todo", "!("), concat!("unimplemented", "!(")];
const HOME_FOLDERS: [&str; 3] = [
    concat!("/ho", "me/"),
    concat!("/ro", "ot/"),
    concat!("/Use", "rs/"),
];

pub(super) fn check(files: &[PathBuf], root: &Path, findings: &mut Findings) -> Result<()> {
    for file in files {
        let path = root.join(file);
        if !path.is_file() {
            continue; // a submodule, or a link to a folder
        }
        let bytes =
            fs::read(&path).with_context(|| format!("{} cannot be read", file.display()))?;
        // What is not text has no lines to check.
        if let Ok(text) = std::str::from_utf8(&bytes) {
            check_text(file, text, findings);
        }
    }
    Ok(())
}

fn check_text(file: &Path, text: &str, findings: &mut Findings) {
    let name = file.display();
    let is_rust = file.extension().is_some_and(|extension| extension == "rs");
    if is_rust {
        let lines = text.lines().count();
        if lines > HARD_LIMIT {
            findings.fault(format!(
                "{name}: {lines} lines; no file may exceed {HARD_LIMIT}"
            ));
        } else if lines > SOFT_LIMIT {
            findings.note(format!(
                "{name}: {lines} lines; beyond {SOFT_LIMIT}, think of splitting"
            ));
        }
    }
    for (number, line) in (1..).zip(text.lines()) {
        let at = format!("{name}:{number}");
        if is_rust && line.contains(BARE_IGNORE) {
            findings.fault(format!(
                "{at}: an ignored test needs its reason in the attribute"
            ));
        }
        // In a comment it is at most a stand-in of an example that is never run.
        let is_code = is_rust && !line.trim_start().starts_with("//");
        if is_code && UNFINISHED.iter().any(|mark| line.contains(mark)) {
            findings.fault(format!("{at}: unfinished code"));
        }
        if HOME_FOLDERS.iter().any(|folder| names_home(line, folder)) {
            findings.fault(format!("{at}: a folder of somebody's machine"));
        }
    }
}

/// Whether a line names a folder below a home folder, as opposed to a longer path that merely
/// contains the same word, or an address.
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

    fn faults(file: &str, text: &str) -> Vec<String> {
        let mut findings = Findings::default();
        check_text(Path::new(file), text, &mut findings);
        findings.faults
    }

    #[test]
    fn length_is_a_note_and_then_a_fault() {
        let mut findings = Findings::default();
        for lines in [SOFT_LIMIT, SOFT_LIMIT + 1, HARD_LIMIT, HARD_LIMIT + 1] {
            check_text(Path::new("a.rs"), &"//\n".repeat(lines), &mut findings);
        }
        assert_eq!((findings.notes.len(), findings.faults.len()), (2, 1));
        assert_eq!(faults("table.md", &"x\n".repeat(9999)), [] as [&str; 0]);
    }

    #[test]
    fn an_ignored_test_needs_a_reason() {
        assert_eq!(
            faults("a.rs", &format!("fn f() {{}}\n{BARE_IGNORE}\n")).len(),
            1
        );
        assert_eq!(
            faults("a.rs", "#[ignore = \"takes an hour\"]\n"),
            [] as [&str; 0]
        );
    }

    #[test]
    fn unfinished_code_is_found_with_its_line() {
        let found = faults("a.rs", &format!("\n    {})\n", UNFINISHED[0]));
        assert_eq!(found, ["a.rs:2: unfinished code"]);
        assert_eq!(faults("a.md", UNFINISHED[0]), [] as [&str; 0]);
        assert_eq!(
            faults("a.rs", &format!("/// # let x = {})", UNFINISHED[1])),
            [] as [&str; 0]
        );
    }

    #[test]
    fn home_folders_are_found_and_addresses_are_not() {
        for folder in HOME_FOLDERS {
            assert_eq!(
                faults("a.md", &format!("see {folder}someone/x")).len(),
                1,
                "{folder}"
            );
            assert_eq!(
                faults("a.md", &format!("https://host{folder}page")),
                [] as [&str; 0]
            );
            assert_eq!(
                faults("a.md", &format!("a{folder}b, {folder} alone")),
                [] as [&str; 0]
            );
        }
    }
}
