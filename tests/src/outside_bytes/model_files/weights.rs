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
    file: Digested,
    /// The numbers of the file.
    numbers: Vec<f32>,
    /// The file of other numbers, which the network has when a file is read.
    others: PathBuf,
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
        let numbers = network.parameters().to_vec()?;
        let others = folder.path().join("others.safetensors");
        let other = smallest::network_of_seed(&config, 2);
        save_parameters(other.parameters(), &origin, &others)?;
        load_parameters(network.parameters(), &origin, &others)?;
        Ok(Self {
            file: Digested::new(std::fs::read(&path)?),
            numbers,
            others,
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
/// When an error changes the network or does not name the file, when the sound file is refused or reads as other numbers, or when what is read is not finite.
pub fn read(bytes: &[u8]) {
    // libtorch's tensors stay on their thread.
    thread_local! {
        static SOUND: Sound = Sound::make().expect("the sound file can be made");
    }
    SOUND.with(|sound| {
        let (parameters, origin) = (sound.network.parameters(), &sound.origin);
        let before = sound.now();
        let read = with_file(&sound.path, &sound.file.edited(bytes), |path| {
            load_parameters(parameters, origin, path)
        });
        let now = sound.now();
        if let Err(error) = read {
            assert!(bytes.len() > 1, "a sound file: {error}");
            names_file(&error, "model.safetensors");
            assert_eq!(now, before, "an error changes nothing");
        } else {
            assert!(now.iter().all(|number| number.is_finite()));
            assert!(bytes.len() > 1 || now == sound.numbers);
            load_parameters(parameters, origin, &sound.others).expect("a sound file");
        }
    });
}
