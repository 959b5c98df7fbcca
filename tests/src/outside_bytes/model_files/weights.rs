//! The weights of a network.

use std::path::PathBuf;

use ddl::network::weights::{Origin, Weights, load_weights, save_weights};
use tempfile::TempDir;

use super::digested::Digested;
use super::{names_file, smallest, with_file};

/// The weights of a network and the sound file of them.
struct Sound {
    weights: Weights,
    origin: Origin,
    file: Digested,
    path: PathBuf,
    _folder: TempDir,
}

impl Sound {
    fn make() -> Result<Self, Box<dyn std::error::Error>> {
        let config = smallest::config();
        let (network, origin) = (smallest::network(&config), config.network_origin());
        let folder = tempfile::tempdir()?;
        let path = folder.path().join("model.safetensors");
        save_weights(network.weights(), &origin, &path)?;
        Ok(Self {
            file: Digested::new(std::fs::read(&path)?),
            weights: network.weights().clone(),
            origin,
            path,
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
        let layout = sound.weights.layout();
        let read = with_file(&sound.path, &sound.file.edited(bytes), |path| {
            load_weights(layout, &sound.origin, path)
        });
        match read {
            Err(error) => {
                assert!(bytes.len() > 1, "a sound file: {error}");
                names_file(&error, "model.safetensors");
            }
            Ok(weights) => {
                assert!(weights.numbers().iter().all(|number| number.is_finite()));
                assert!(bytes.len() > 1 || weights == sound.weights);
            }
        }
    });
}
