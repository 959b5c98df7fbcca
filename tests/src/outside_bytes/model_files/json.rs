//! `config.json` and `metrics.jsonl`.

use ddl::RunDirectory;
use tempfile::TempDir;

use super::{names_file, smallest, with_file};
use crate::outside_bytes::edits::Choices;

/// The bytes themselves, or edits of a valid file; the first byte decides.
pub fn read_run_config(bytes: &[u8]) {
    thread_local! {
        static SOUND: (String, TempDir) = (
            serde_json::to_string(&smallest::config()).expect("a configuration can be written"),
            tempfile::tempdir().expect("a folder can be made"),
        );
    }
    let Some((&way, bytes)) = bytes.split_first() else {
        return;
    };
    SOUND.with(|(sound, folder)| {
        let text = match way & 1 {
            0 => bytes.to_vec(),
            _ => Choices::edited(bytes, sound.as_bytes()),
        };
        let run = RunDirectory::new(folder.path());
        let path = folder.path().join("config.json");
        match with_file(&path, &text, |_| run.config()) {
            Err(error) => names_file(&error, &folder.path().display().to_string()),
            Ok(config) => {
                let _ = (config.star.check(), config.goals.check(), config.training.check());
                let written = serde_json::to_string(&config).expect("a valid configuration can be written");
                let again = with_file(&path, written.as_bytes(), |_| run.config());
                assert_eq!(again.ok(), Some(config));
            }
        }
    });
}

/// The bytes themselves.
pub fn read_metrics(bytes: &[u8]) {
    thread_local! {
        static FOLDER: TempDir = tempfile::tempdir().expect("a folder can be made");
    }
    FOLDER.with(|folder| {
        let run = RunDirectory::new(folder.path());
        let path = folder.path().join("metrics.jsonl");
        if let Err(error) = with_file(&path, bytes, |_| run.metrics()) {
            names_file(&error, "metrics.jsonl");
        }
    });
}
