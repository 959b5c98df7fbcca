//! The memory of a training run does not grow with its steps.
//!
//! Measured in a process of its own, started anew from this very test, because the other tests of this program use memory
//! as they like.

use ddl::data::WindowRule;
use ddl::network::{StarConfig, TrainingConfig};
use ddl::star::{ComputeDevice, TorchNetwork, Trainer};
use ddl::{DeviceChoice, Variant};
use ddl_tests::{crowd, processes, tiny_model};
use std::path::Path;
use std::process::Command;

/// Set in the child: the file to write the growth to, the steps, and the bytes to lose at each.
const CHILD: &str = "DDL_TESTS_TRAINING_MEMORY";
const MIB: u64 = 1 << 20;
/// Growth that counts as none: what allocators keep for themselves, two huge pages among it. Over 900 steps, 7 KiB a step.
const TOLERANCE: u64 = 6 * MIB;

/// Trains the steps of the batches that are visited round and round, losing `lost` bytes at each; how much more is resident
/// after the last step than after the `first`.
fn growth([first, last, lost]: [u64; 3]) -> Option<u64> {
    tiny_model::use_one_thread();
    let config = StarConfig {
        model_width: 8,
        heads: 2,
        feed_forward_width: 32,
        ..StarConfig::published(Variant::Full)
    };
    let training = TrainingConfig {
        epochs: 1_000_000, // never done
        batch_walkers: 8,
        ..TrainingConfig::published()
    };
    let dataset = crowd::dataset();
    let fold = dataset.fold(crowd::FOLD).unwrap();
    let mut windows = fold.training_windows(WindowRule::Complete);
    windows.truncate(40); // all of them are visited within the first steps
    let device = ComputeDevice::open(DeviceChoice::Cpu).unwrap();
    let network = TorchNetwork::new(config, 1, device).unwrap();
    let mut trainer = Trainer::new(network, windows, training).unwrap();
    let mut leak = Vec::new();
    let mut before = 0;
    for step in 1..=last {
        trainer.step().unwrap();
        leak.push(vec![1_u8; lost as usize]);
        if step == first {
            before = processes::resident_bytes()?;
        }
    }
    let after = processes::resident_bytes()?;
    drop(std::hint::black_box(leak));
    Some(after.saturating_sub(before))
}

/// The same in a process of its own.
fn growth_alone(folder: &Path, steps: [u64; 3]) -> Option<u64> {
    let file = folder.join("growth");
    let [first, last, lost] = steps;
    let told = format!("{}\n{first}\n{last}\n{lost}", file.display());
    let output = Command::new(std::env::current_exe().unwrap())
        .args(["--exact", "training_memory::steps_do_not_add_up_in_memory"])
        .env(CHILD, told)
        .output()
        .unwrap();
    assert!(output.status.success(), "{output:?}");
    std::fs::read_to_string(file).unwrap().parse().ok()
}

/// What the child does.
fn be_the_child(told: &str) {
    let (file, numbers) = told.split_once('\n').unwrap();
    let numbers: Vec<u64> = numbers.lines().map(|n| n.parse().unwrap()).collect();
    let growth = growth(numbers.try_into().unwrap());
    std::fs::write(file, growth.map_or("unknown".to_owned(), |g| g.to_string())).unwrap();
}

#[test]
fn steps_do_not_add_up_in_memory() {
    if let Ok(told) = std::env::var(CHILD) {
        return be_the_child(&told);
    }
    let folder = tempfile::tempdir().unwrap();
    let Some(lossy) = growth_alone(folder.path(), [60, 100, 512 << 10]) else {
        eprintln!("skipped: this system does not tell the memory of a process");
        return;
    };
    // 20 MiB are lost on purpose: seen, or the test shows nothing
    assert!((15 * MIB..30 * MIB).contains(&lossy), "{lossy} bytes");
    let growth = growth_alone(folder.path(), [100, 1000, 0]).unwrap();
    assert!(
        growth <= TOLERANCE,
        "{growth} bytes more after 1,000 steps than after 100"
    );
}
