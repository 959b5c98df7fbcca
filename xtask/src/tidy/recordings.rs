//! No trajectory data is tracked: the terms of the originals do not clearly allow passing it on.

use std::path::{Path, PathBuf};

use anyhow::Result;

use super::Findings;
use crate::data::{Manifest, RECORDED};
use crate::digest::measure;
use crate::workspace::Workspace;

/// What may lie in `datasets/`.
const DESCRIPTIONS: [&str; 3] = [
    "datasets/README.md",
    "datasets/manifest.toml",
    "datasets/folds.toml",
];

/// The name and hash of every pinned recording.
struct Recordings(Vec<(String, String)>);

pub(super) fn check(
    files: &[PathBuf],
    workspace: &Workspace,
    findings: &mut Findings,
) -> Result<()> {
    let manifest = Manifest::load(workspace)?;
    let pinned = RECORDED
        .into_iter()
        .flat_map(|convention| manifest.entry(convention))
        .flat_map(|entry| &entry.files)
        .map(|file| (file.name.clone(), file.sha256.clone()));
    let recordings = Recordings(pinned.collect());
    for file in files
        .iter()
        .filter(|file| workspace.root().join(file).is_file())
    {
        recordings.check(file, workspace.root(), findings)?;
    }
    Ok(())
}

impl Recordings {
    fn check(&self, file: &Path, root: &Path, findings: &mut Findings) -> Result<()> {
        let shown = file.display();
        if file.starts_with("datasets")
            && !DESCRIPTIONS.iter().any(|known| file == Path::new(known))
        {
            findings.fault(format!(
                "{shown}: datasets/ holds descriptions only, no data"
            ));
        }
        let name = file
            .file_name()
            .and_then(|name| name.to_str())
            .unwrap_or_default();
        if self.0.iter().any(|(recording, _)| recording == name) {
            findings.fault(format!(
                "{shown}: a recording by its name; none may be committed"
            ));
        }
        let (sha256, _) = measure(&root.join(file))?;
        if let Some((recording, _)) = self.0.iter().find(|(_, pinned)| *pinned == sha256) {
            findings.fault(format!(
                "{shown}: the recording {recording}; none may be committed"
            ));
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    #[test]
    fn a_recording_is_found_by_place_by_name_and_by_contents() {
        let root = tempfile::tempdir().unwrap();
        fs::create_dir_all(root.path().join("datasets")).unwrap();
        for (file, contents) in [
            ("datasets/folds.toml", "x"),
            ("datasets/new.csv", "x"),
            ("eth.csv", "x"),
            ("renamed.txt", "abc"),
        ] {
            fs::write(root.path().join(file), contents).unwrap();
        }
        let (abc, _) = measure(&root.path().join("renamed.txt")).unwrap();
        let recordings = Recordings(vec![("eth.csv".to_owned(), abc)]);
        let faults = |file: &str| {
            let mut findings = Findings::default();
            recordings
                .check(Path::new(file), root.path(), &mut findings)
                .unwrap();
            findings.faults
        };
        assert_eq!(faults("datasets/folds.toml"), [] as [&str; 0]);
        assert!(faults("datasets/new.csv")[0].contains("descriptions only"));
        assert!(faults("eth.csv")[0].contains("by its name"));
        assert!(faults("renamed.txt")[0].contains("the recording eth.csv"));
    }
}
