//! The programs and libraries reach no network: only what fetches libtorch, recordings and tools does, with Python and cargo.
//!
//! What depends on what in the end is checked by `cargo xtask deny`; this check is about the crates' own code and their
//! direct dependencies, with the same list: `[bans] deny` of `deny.toml`.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result};
use serde_json::Value;

use super::Findings;

const LIST: &str = "deny.toml";
/// Where the fetching is done.
const FETCHING: &str = "xtask/src/python";
/// Tests of the fetching play the server.
const PLAYS_SERVER: &str = "xtask/src/data/fetch_tests.rs";

// Spelled in pieces, so that this file does not find itself.
const RUST: [&str; 6] = [
    concat!("std::", "net"),
    concat!("core::", "net"),
    concat!("Tcp", "Stream"),
    concat!("Tcp", "Listener"),
    concat!("Udp", "Socket"),
    concat!("ToSocket", "Addrs"),
];
const PYTHON: [&str; 4] = ["urllib", "socket", "http", "requests"];

pub(super) fn check(
    metadata: &Value,
    files: &[PathBuf],
    root: &Path,
    findings: &mut Findings,
) -> Result<()> {
    let text = fs::read_to_string(root.join(LIST)).with_context(|| format!("{LIST} is missing"))?;
    let banned = banned(&text)?;
    if banned.is_empty() {
        findings.fault(format!("{LIST}: no network client is banned"));
    }
    check_dependencies(metadata, &banned, findings);
    for file in files {
        let Ok(text) = fs::read_to_string(root.join(file)) else {
            continue; // deleted, a folder, or no text
        };
        check_text(file, &text, findings);
    }
    Ok(())
}

/// The crates that `deny.toml` bans.
fn banned(text: &str) -> Result<Vec<String>> {
    let list: toml::Table = text
        .parse()
        .with_context(|| format!("{LIST} cannot be read"))?;
    let entries = list.get("bans").and_then(|bans| bans.get("deny"));
    let entries = entries
        .and_then(toml::Value::as_array)
        .into_iter()
        .flatten();
    let name = |entry: &toml::Value| Some(entry.get("crate")?.as_str()?.to_owned());
    Ok(entries.filter_map(name).collect())
}

fn check_dependencies(metadata: &Value, banned: &[String], findings: &mut Findings) {
    for package in metadata["packages"].as_array().into_iter().flatten() {
        let dependencies = package["dependencies"].as_array().into_iter().flatten();
        for name in dependencies.filter_map(|dependency| dependency["name"].as_str()) {
            if banned.iter().any(|one| one == name) {
                let from = package["name"].as_str().unwrap_or("a crate");
                findings.fault(format!("{from} must not depend on {name}: see {LIST}"));
            }
        }
    }
}

fn check_text(file: &Path, text: &str, findings: &mut Findings) {
    if file.starts_with(FETCHING) || file == Path::new(PLAYS_SERVER) {
        return;
    }
    let extension = file.extension().and_then(|e| e.to_str()).unwrap_or("");
    for (number, line) in (1..).zip(text.lines()) {
        let used = match extension {
            "rs" => RUST.into_iter().find(|word| has_word(line, word)),
            "py" => imported(line),
            _ => None,
        };
        if let Some(word) = used {
            findings.fault(format!(
                "{}:{number}: {word}: nothing outside {FETCHING} reaches a network",
                file.display()
            ));
        }
    }
}

/// The module of the network that a line of Python imports.
fn imported(line: &str) -> Option<&'static str> {
    let mut words = line.split([' ', ',', '.']).filter(|word| !word.is_empty());
    let is_import = matches!(words.next(), Some("import" | "from"));
    PYTHON
        .into_iter()
        .find(|module| is_import && words.clone().any(|word| word == *module))
}

/// Whether a line holds the word, and not as a part of a longer one.
fn has_word(line: &str, word: &str) -> bool {
    let belongs = |c: char| c.is_alphanumeric() || c == '_';
    line.match_indices(word).any(|(at, _)| {
        let before = line[..at].chars().next_back();
        let after = line[at + word.len()..].chars().next();
        !before.is_some_and(belongs) && !after.is_some_and(belongs)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn faults(file: &str, text: &str) -> Vec<String> {
        let mut findings = Findings::default();
        check_text(Path::new(file), text, &mut findings);
        findings.faults
    }

    #[test]
    fn the_list_bans_clients_with_reasons() {
        let text = include_str!("../../../deny.toml");
        let banned = banned(text).unwrap();
        for client in ["reqwest", "ureq", "hyper", "curl", "tokio"] {
            assert!(banned.iter().any(|one| one == client), "{client}");
        }
        let reasons = text.matches("reason = \"").count();
        assert!(reasons >= banned.len(), "{reasons} of {}", banned.len());
    }

    #[test]
    fn a_banned_dependency_is_named() {
        let dependencies = [json!({ "name": "ureq" }), json!({ "name": "serde" })];
        let package = json!({ "name": "ddl-data", "dependencies": dependencies });
        let mut findings = Findings::default();
        let banned = banned("[bans]\ndeny = [{ crate = \"ureq\", reason = \"x\" }]").unwrap();
        check_dependencies(&json!({ "packages": [package] }), &banned, &mut findings);
        assert_eq!(
            findings.faults,
            ["ddl-data must not depend on ureq: see deny.toml"]
        );
    }

    #[test]
    fn sockets_are_found_in_crates_and_not_where_things_are_fetched() {
        let line = format!("use {}::{};\n", RUST[0], RUST[2]);
        assert_eq!(faults("crates/ddl/src/forecast/live.rs", &line).len(), 1);
        assert_eq!(faults("xtask/src/digest.rs", &line).len(), 1);
        assert_eq!(faults(PLAYS_SERVER, &line), [] as [&str; 0]);
        assert_eq!(faults("docs/page.md", &line), [] as [&str; 0]);
        let longer = format!("let my{}s = {}work;", RUST[2], RUST[0]);
        assert_eq!(faults("a.rs", &longer), [] as [&str; 0]);
    }

    #[test]
    fn python_that_fetches_is_found_elsewhere() {
        for line in [
            "import urllib.request",
            "from http import server",
            "import json, socket",
        ] {
            assert_eq!(faults("tests/page/a.py", line).len(), 1, "{line}");
            assert_eq!(
                faults("xtask/src/python/a.py", line),
                [] as [&str; 0],
                "{line}"
            );
        }
        assert_eq!(faults("a.py", "requests = 3"), [] as [&str; 0]);
    }
}
