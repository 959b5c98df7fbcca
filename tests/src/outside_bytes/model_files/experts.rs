//! The expert library of a run.

use ddl::{DeviceChoice, GoalModel, GoalRecipe, RunDirectory};
use tempfile::TempDir;

use super::digested::Digested;
use super::{names_file, smallest, with_file};
use crate::drawn_model;

/// A run whose goals come from its library alone, and its sound file.
struct Sound {
    run: RunDirectory,
    file: Digested,
    _folder: TempDir,
}

impl Sound {
    fn make() -> Result<Self, Box<dyn std::error::Error>> {
        let mut config = smallest::config();
        config.goals = GoalRecipe::retrieved(1);
        let positions: Vec<f64> = (0..2 * 20 * 2).map(|i| 0.25 * f64::from(i)).collect();
        let folder = tempfile::tempdir()?;
        let run = RunDirectory::new(folder.path());
        let text = serde_json::to_string(&config)?;
        std::fs::write(run.path().join("config.json"), text)?;
        Ok(Self {
            run,
            file: Digested::new(drawn_model::experts(&config, &positions)),
            _folder: folder,
        })
    }
}

/// Edits of a sound file.
pub fn read(bytes: &[u8]) {
    thread_local! {
        static SOUND: Sound = Sound::make().expect("the sound file can be made");
    }
    SOUND.with(|sound| {
        let read = with_file(&sound.run.experts(), &sound.file.edited(bytes), |_| {
            GoalModel::load(sound.run.path(), DeviceChoice::Cpu)
        });
        if let Err(error) = read {
            assert!(bytes.len() > 1, "a sound file: {error}");
            names_file(&error, &sound.run.experts().display().to_string());
        }
    });
}
