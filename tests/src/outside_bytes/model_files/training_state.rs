//! The state of a training under way.

use std::cell::RefCell;
use std::path::PathBuf;

use ddl::DeviceChoice;
use ddl::network::weights::Origin;
use ddl::network::{Objective, TrainingConfig};
use ddl::star::{ComputeDevice, TorchNetwork, Trainer};
use ddl_data::{PedestrianId, Window};
use tempfile::TempDir;

use super::digested::Digested;
use super::{names_file, smallest, with_file};

/// A training and the sound file of its state.
struct Sound {
    trainer: Trainer,
    origin: Origin,
    file: Digested,
    path: PathBuf,
    _folder: TempDir,
}

impl Sound {
    fn make() -> Result<Self, Box<dyn std::error::Error>> {
        let config = smallest::config();
        let origin = config.network_origin();
        let training = TrainingConfig {
            objective: Objective::NextStep,
            jitter: 0.0,
            epochs: 3,
            ..config.training.clone()
        };
        let walk = (0..20).map(|t| [0.5 * f64::from(t), 0.0]).collect();
        let window = Window::new("yard", 0, 10, vec![PedestrianId(1)], vec![walk])?;
        let device = ComputeDevice::open(DeviceChoice::Cpu)?;
        let network = TorchNetwork::new(config.star.clone(), 1, device)?;
        let mut trainer = Trainer::new(network, vec![window], training)?;
        let folder = tempfile::tempdir()?;
        let path = folder.path().join("optimizer.safetensors");
        trainer.save(&origin, &path)?;
        Ok(Self {
            trainer,
            origin,
            file: Digested::new(std::fs::read(&path)?),
            path,
            _folder: folder,
        })
    }
}

/// Edits of a sound file.
pub fn read(bytes: &[u8]) {
    // libtorch's tensors stay on their thread.
    thread_local! {
        static SOUND: RefCell<Sound> = RefCell::new(Sound::make().expect("the sound file can be made"));
    }
    SOUND.with_borrow_mut(|sound| {
        let file = sound.file.edited(bytes);
        let Sound {
            trainer,
            origin,
            path,
            ..
        } = sound;
        let before = trainer.steps();
        if let Err(error) = with_file(path, &file, |path| trainer.resume(origin, path)) {
            assert!(bytes.len() > 1, "a sound file: {error}");
            names_file(&error, "optimizer.safetensors");
            assert_eq!(trainer.steps(), before, "an error changes nothing");
        } else {
            let (steps, total) = trainer.steps();
            assert!(steps <= total);
        }
    });
}
