//! The weights of a network.

use std::path::PathBuf;

use ddl::star::{Origin, StarNetwork, load_parameters, save_parameters};
use tempfile::TempDir;

use super::digested::Digested;
use super::{names_file, smallest, with_file};

/// A network and the sound file of its weights.
struct Sound {
    network: StarNetwork,
    origin: Origin,
    numbers: Vec<f32>,
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
        save_parameters(network.parameters(), &origin, &path)?;
        Ok(Self {
            numbers: network.parameters().to_vec()?,
            file: Digested::new(std::fs::read(&path)?),
            network,
            origin,
            path,
            _folder: folder,
        })
    }

    fn now(&self) -> Vec<f32> {
        let parameters = self.network.parameters();
        parameters.to_vec().expect("the CPU's numbers can be read")
    }
}

/// Edits of a sound file.
///
/// # Panics
/// When an error changes the network, or what is read is no number or, of a file without edits, another one.
pub fn read(bytes: &[u8]) {
    // libtorch's tensors stay on their thread.
    thread_local! {
        static SOUND: Sound = Sound::make().expect("the sound file can be made");
    }
    SOUND.with(|sound| {
        let before = sound.now();
        let read = with_file(&sound.path, &sound.file.edited(bytes), |path| {
            load_parameters(sound.network.parameters(), &sound.origin, path)
        });
        let now = sound.now();
        if let Err(error) = read {
            assert!(bytes.len() > 1, "a sound file: {error}");
            names_file(&error, "model.safetensors");
            assert_eq!(now, before, "an error changes nothing");
        } else {
            assert!(now.iter().all(|number| number.is_finite()));
            assert!(bytes.len() > 1 || now == sound.numbers);
        }
    });
}
