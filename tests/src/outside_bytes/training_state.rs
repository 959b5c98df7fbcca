//! The state of an unfinished training.

use std::cell::RefCell;

use ddl::DeviceChoice;
use ddl::network::weights::Origin;
use ddl::network::{Objective, TrainingConfig};
use ddl::star::{ComputeDevice, TorchNetwork, Trainer};
use ddl_core::{PedestrianId, Window};

use super::model_files::{smallest_config, without_digest};
use super::valid_file::ValidFile;

fn training() -> Result<(Trainer, Origin), Box<dyn std::error::Error>> {
    let config = smallest_config();
    let training = TrainingConfig { objective: Objective::NextStep, jitter: 0.0, epochs: 3, ..config.training.clone() };
    let walk = (0..20).map(|t| [0.5 * f64::from(t), 0.0]).collect();
    let window = Window::new("yard", 0, 10, vec![PedestrianId(1)], vec![walk])?;
    let device = ComputeDevice::open(DeviceChoice::Cpu)?;
    let network = TorchNetwork::new(config.star.clone(), 1, device)?;
    let trainer = Trainer::new(network, vec![window], None, training)?;
    Ok((trainer, config.network_origin()))
}

/// The file of a training, and what resumes it.
type Resumable = ValidFile<(RefCell<Trainer>, Origin)>;

/// Edits of a valid file.
pub(super) fn read(bytes: &[u8]) {
    // Tensors of libtorch stay on their thread.
    thread_local! {
        static VALID: Resumable = ValidFile::new("optimizer.safetensors", without_digest, |path| {
            let (trainer, origin) = training().expect("the training can be started");
            trainer.save(&origin, path).expect("its state can be written");
            (RefCell::new(trainer), origin)
        });
    }
    VALID.with(|valid| {
        let steps = || valid.with.0.borrow().steps();
        let before = steps();
        let read = valid.read(bytes, |(trainer, origin), path| trainer.borrow_mut().resume(origin, path));
        if read.is_err() {
            assert_eq!(steps(), before, "an error changes nothing");
        } else {
            assert!(steps().done <= steps().total);
        }
    });
}
