//! One step of training.

use crate::{Result, median};
use ddl::data::{Dataset, Window, WindowRule};
use ddl::network::{StarConfig, TrainingConfig};
use ddl::star::{ComputeDevice, TorchNetwork, Trainer};
use ddl::{DeviceChoice, Variant};
use rustix::time::ClockId;

/// Prints the time of a step with one thread and with two.
#[expect(clippy::print_stdout, reason = "the results")]
pub(crate) fn measure(dataset: &Dataset, runs: usize) -> Result<()> {
    let training = TrainingConfig {
        epochs: 1_000_000, // never done
        ..TrainingConfig::published()
    };
    // Windows with few pedestrians each, as in most recordings.
    let windows = dataset.fold("corridor")?.training_windows(WindowRule::Complete);
    let mut pedestrians = 0;
    let mut batch: Vec<Window> = Vec::new();
    for window in windows.into_iter().step_by(40) {
        if pedestrians <= training.batch_pedestrians {
            pedestrians += window.len();
            batch.push(window);
        }
    }
    for (threads, clock) in [(1, ClockId::ProcessCPUTime), (2, ClockId::Monotonic)] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build()?;
        let (scenes, batch, training) = (batch.len(), batch.clone(), training.clone());
        let step = pool.install(|| {
            let device = ComputeDevice::open(DeviceChoice::Cpu)?;
            let network = TorchNetwork::new(StarConfig::published(Variant::Full), 1, device)?;
            let mut trainer = Trainer::new(network, batch, None, training)?;
            median(clock, runs, || Ok(trainer.step().map(drop)?))
        })?;
        println!("{pedestrians} pedestrians in {scenes} scenes, threads: {threads}: {step:.3} s ({clock:?})");
    }
    Ok(())
}
