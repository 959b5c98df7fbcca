//! Every crate can stand alone: described, documented, licensed.

use std::path::Path;

use serde_json::Value;

use super::Findings;

const LICENSE: &str = "MIT OR Apache-2.0";

/// Keywords, or categories, of a crate.
const MOST_WORDS: usize = 5;

/// Texts that the licence names.
const LICENSE_FILES: [&str; 2] = ["LICENSE-MIT", "LICENSE-APACHE"];

pub(super) fn check(metadata: &Value, root: &Path, findings: &mut Findings) {
    for file in LICENSE_FILES
        .iter()
        .filter(|file| !root.join(file).is_file())
    {
        findings.fault(format!("{file} is missing"));
    }
    for package in metadata["packages"].as_array().into_iter().flatten() {
        let Some(name) = package["name"].as_str() else {
            continue;
        };
        if package["license"].as_str() != Some(LICENSE) {
            findings.fault(format!("{name}: the licence must be {LICENSE}"));
        }
        if package["description"].as_str().is_none_or(str::is_empty) {
            findings.fault(format!("{name}: the description is missing"));
        }
        check_registry(name, package, findings);
        let folder = package["manifest_path"]
            .as_str()
            .map(Path::new)
            .and_then(Path::parent);
        // An empty list in the metadata is `publish = false`: a crate nobody takes alone.
        let is_published = package["publish"].is_null();
        if is_published && !folder.is_some_and(|folder| folder.join("README.md").is_file()) {
            findings.fault(format!("{name}: README.md is missing"));
        }
        let manifest =
            folder.and_then(|folder| std::fs::read_to_string(folder.join("Cargo.toml")).ok());
        if !manifest.is_some_and(|manifest| inherits_lints(&manifest)) {
            findings.fault(format!(
                "{name}: Cargo.toml must say `[lints] workspace = true`"
            ));
        }
    }
}

/// What a registry asks of a crate that is published, beyond licence and description.
fn check_registry(name: &str, package: &Value, findings: &mut Findings) {
    // An empty list in the metadata is `publish = false`.
    if !package["publish"].is_null() {
        return;
    }
    for field in ["repository", "readme", "rust_version"] {
        if package[field].as_str().is_none_or(str::is_empty) {
            findings.fault(format!("{name}: {field} is missing"));
        }
    }
    for field in ["keywords", "categories"] {
        let words: Vec<&str> = package[field]
            .as_array()
            .into_iter()
            .flatten()
            .filter_map(Value::as_str)
            .collect();
        if !(1..=MOST_WORDS).contains(&words.len()) {
            findings.fault(format!("{name}: {field}: 1 to {MOST_WORDS} are asked for"));
        }
        for word in words.iter().filter(|word| !is_word(field, word)) {
            findings.fault(format!("{name}: {field}: a registry refuses {word:?}"));
        }
    }
    for dependency in package["dependencies"].as_array().into_iter().flatten() {
        let is_path = dependency["path"].is_string();
        if is_path
            && dependency["req"]
                .as_str()
                .is_none_or(|version| version == "*")
        {
            let to = dependency["name"].as_str().unwrap_or("a crate");
            findings.fault(format!(
                "{name}: {to} has a path and no version: nobody else can build it"
            ));
        }
    }
}

/// A keyword is at most 20 letters, digits, `_`, `-` or `+` and begins with a letter or digit; a category is one of the registry's.
fn is_word(field: &str, word: &str) -> bool {
    let allowed = |c: char| {
        c.is_ascii_alphanumeric() || "_-+".contains(c) || field == "categories" && c == ':'
    };
    let short = word.len() <= 20 || field == "categories";
    word.starts_with(|c: char| c.is_ascii_alphanumeric()) && short && word.chars().all(allowed)
}

fn inherits_lints(manifest: &str) -> bool {
    manifest.parse::<toml::Table>().is_ok_and(|table| {
        table
            .get("lints")
            .and_then(|lints| lints.get("workspace")?.as_bool())
            == Some(true)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;
    use std::fs;

    #[test]
    fn a_bare_crate_is_told_everything_it_lacks() {
        let root = tempfile::tempdir().unwrap();
        let manifest = root.path().join("Cargo.toml");
        fs::write(&manifest, "[package]\nname = \"bare\"\n").unwrap();
        let package = json!({
            "name": "bare", "license": "MIT", "description": null, "publish": null,
            "manifest_path": manifest,
        });
        let mut findings = Findings::default();
        check(
            &json!({ "packages": [package] }),
            root.path(),
            &mut findings,
        );
        let all = findings.faults.join("\n");
        for lack in [
            "LICENSE-MIT",
            "LICENSE-APACHE",
            "licence",
            "description",
            "README",
            "lints",
            "repository is missing",
            "readme is missing",
            "rust_version is missing",
            "keywords: 1 to 5",
            "categories: 1 to 5",
        ] {
            assert!(all.contains(lack), "{lack}: {all}");
        }
        assert_eq!(findings.faults.len(), 11);
    }

    #[test]
    fn a_whole_crate_passes() {
        let root = tempfile::tempdir().unwrap();
        for (file, text) in [
            ("LICENSE-MIT", ""),
            ("LICENSE-APACHE", ""),
            ("README.md", ""),
            ("Cargo.toml", "[lints]\nworkspace = true\n"),
        ] {
            fs::write(root.path().join(file), text).unwrap();
        }
        let package = json!({
            "name": "whole", "license": LICENSE, "description": "x", "publish": null,
            "repository": "https://host/x", "readme": "README.md", "rust_version": "1.94",
            "keywords": ["soft-dtw"], "categories": ["science::robotics"],
            "dependencies": [{ "name": "other", "path": "/w/other", "req": "^0.1.0" }],
            "manifest_path": root.path().join("Cargo.toml"),
        });
        let mut findings = Findings::default();
        check(
            &json!({ "packages": [package] }),
            root.path(),
            &mut findings,
        );
        assert_eq!(findings.faults, [] as [&str; 0]);
    }
    #[test]
    fn what_a_registry_refuses_is_named() {
        let package = json!({
            "publish": null, "repository": "https://host/x", "readme": "README.md", "rust_version": "1.94",
            "keywords": ["two words", "a-keyword-that-is-too-long"],
            "categories": ["a", "b", "c", "d", "e", "f"],
            "dependencies": [{ "name": "other", "path": "/w/other", "req": "*" }],
        });
        let mut findings = Findings::default();
        check_registry("odd", &package, &mut findings);
        assert_eq!(
            findings.faults,
            [
                "odd: keywords: a registry refuses \"two words\"",
                "odd: keywords: a registry refuses \"a-keyword-that-is-too-long\"",
                "odd: categories: 1 to 5 are asked for",
                "odd: other has a path and no version: nobody else can build it",
            ]
        );
    }
}
