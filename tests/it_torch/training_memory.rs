//! The memory of a training run does not grow with its steps: measured in a process of its own, because the other tests
//! of this program use memory as they like.

use ddl::network::{StarConfig, TrainingConfig};
use ddl::star::{ComputeDevice, TorchNetwork, Trainer};
use ddl::{DeviceChoice, Variant};
use ddl_tests::{crowd, processes, trained_model};

/// MiB of growth that count as none: what allocators keep for themselves, two huge pages among it. Over 900 steps, 7 KiB a step.
const TOLERANCE: f64 = 6.0;

/// Trains the steps of the batches that are visited round and round, losing `lost` bytes at each; how many MiB more are
/// resident after the last step than after the `first`.
fn growth([first, last, lost]: [usize; 3]) -> Option<Vec<f64>> {
    trained_model::use_one_thread();
    let config = StarConfig {
        model_width: 8,
        heads: 2,
        feed_forward_width: 32,
        ..StarConfig::published(Variant::Full)
    };
    let training = TrainingConfig {
        epochs: 1_000_000, // never done
        batch_pedestrians: 8,
        ..TrainingConfig::published()
    };
    let mut windows = crowd::training_windows();
    windows.truncate(40); // all of them are visited within the first steps
    let device = ComputeDevice::open(DeviceChoice::Cpu).unwrap();
    let network = TorchNetwork::new(config, 1, device).unwrap();
    let mut trainer = Trainer::new(network, windows, training).unwrap();
    let mut leak = Vec::new();
    let mut before = 0;
    for step in 1..=last {
        trainer.step().unwrap();
        leak.push(vec![1_u8; lost]);
        if step == first {
            before = processes::resident_bytes()?;
        }
    }
    let after = processes::resident_bytes()?;
    drop(std::hint::black_box(leak));
    Some(vec![
        after.saturating_sub(before) as f64 / f64::from(1 << 20),
    ])
}

/// 20 MiB are lost on purpose: seen, or the test shows nothing.
#[test]
fn what_is_lost_is_seen() {
    let test = "training_memory::what_is_lost_is_seen";
    if let Some(lost) = processes::alone(test, || growth([60, 100, 512 << 10])) {
        assert!((15.0..30.0).contains(&lost[0]), "{lost:?} MiB");
    }
}

#[test]
fn steps_do_not_add_up_in_memory() {
    let test = "training_memory::steps_do_not_add_up_in_memory";
    if let Some(growth) = processes::alone(test, || growth([100, 1000, 0])) {
        let steps = "more after 1,000 steps than after 100";
        assert!(growth[0] <= TOLERANCE, "{growth:?} MiB {steps}");
    }
}
