//! The expert library of a run.

use ddl::network::weights::numbers_digest;
use ddl::{DeviceChoice, GoalModel, GoalRecipe, RunDirectory};
use safetensors::tensor::{Dtype, TensorView};
use tempfile::TempDir;

use super::digested::Digested;
use super::{names_file, smallest, with_file};

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
        let positions: Vec<u8> = (0..2 * 20 * 2)
            .flat_map(|i| (0.25 * f64::from(i)).to_le_bytes())
            .collect();
        let view = TensorView::new(Dtype::F64, vec![2, 20, 2], &positions)?;
        let header = config
            .goals_origin()
            .to_header(&numbers_digest([("tracks", view.clone())]));
        let folder = tempfile::tempdir()?;
        let run = RunDirectory::new(folder.path());
        let config = serde_json::to_string(&config)?;
        std::fs::write(run.path().join("config.json"), config)?;
        Ok(Self {
            run,
            file: Digested::new(safetensors::serialize([("tracks", view)], Some(header))?),
            _folder: folder,
        })
    }
}

/// Edits of a sound file.
///
/// # Panics
/// When an error does not name the file, or the sound one is refused.
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
