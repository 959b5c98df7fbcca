//! Every crate can stand alone: described, documented, licensed.

use std::path::Path;

use serde_json::Value;

use super::Findings;

const LICENSE: &str = "MIT OR Apache-2.0";

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
        ] {
            assert!(all.contains(lack), "{lack}: {all}");
        }
        assert_eq!(findings.faults.len(), 6);
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
}
