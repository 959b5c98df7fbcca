//! The memory of a training run does not grow with its steps. Measured in a separate process, because the other tests
//! of this program use memory as well.

use ddl::network::{StarConfig, TrainingConfig};
use ddl::star::{ComputeDevice, TorchNetwork, Trainer};
use ddl::{DeviceChoice, Variant};
use ddl_tests::{crowd, processes, trained_model};

/// Allowed growth (MiB): reserves of allocators, including two huge pages. Over 900 steps this is 7 KiB per step.
const TOLERANCE: f64 = 6.0;

/// Trains on the same batches repeatedly. Returns how many MiB more are resident after the last step than after the
/// `first`.
fn growth(first: usize, last: usize) -> Option<Vec<f64>> {
    trained_model::use_one_thread();
    let config = StarConfig {
        model_width: 8,
        heads: 2,
        feed_forward_width: 32,
        ..StarConfig::published(Variant::Full)
    };
    let training = TrainingConfig {
        epochs: 1_000_000, // never reached
        batch_pedestrians: 8,
        ..TrainingConfig::published()
    };
    let mut windows = crowd::training_windows();
    windows.truncate(40); // all of them are visited within the first steps
    let device = ComputeDevice::open(DeviceChoice::Cpu).unwrap();
    let network = TorchNetwork::new(config, 1, device).unwrap();
    let mut trainer = Trainer::new(network, windows, None, training).unwrap();
    let mut before = 0;
    for step in 1..=last {
        trainer.step().unwrap();
        if step == first {
            before = processes::resident_bytes()?;
        }
    }
    let after = processes::resident_bytes()?;
    Some(vec![after.saturating_sub(before) as f64 / f64::from(1 << 20)])
}

#[test]
fn steps_need_constant_memory() {
    let test = "training_memory::steps_need_constant_memory";
    if let Some(growth) = processes::alone(test, || growth(100, 1000)) {
        let steps = "more after 1,000 steps than after 100";
        assert!(growth[0] <= TOLERANCE, "{growth:?} MiB {steps}");
    }
}
