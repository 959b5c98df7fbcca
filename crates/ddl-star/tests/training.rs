//! Training: what it learns, and that a stopped and resumed run gives the same result.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

use ddl_core::Window;
use ddl_data::{Dataset, WindowRule};
use ddl_network::weights::Origin;
use ddl_network::{DeviceChoice, LearningRateSchedule, NetworkError, StarConfig, TrainingConfig, Variant};
use ddl_star::{ComputeDevice, StarError, TorchNetwork, Trainer};

fn cpu() -> ComputeDevice {
    ddl_star::set_threads(1);
    ComputeDevice::open(DeviceChoice::Cpu).unwrap()
}

fn windows() -> Vec<Window> {
    Dataset::simulated(1).recordings()[0].windows(WindowRule::Complete).into_iter().take(24).collect()
}

fn config(variant: Variant) -> StarConfig {
    StarConfig { feed_forward_width: 64, ..StarConfig::published(variant) }
}

fn trainer(variant: Variant, epochs: usize) -> Trainer {
    let network = TorchNetwork::new(config(variant), 7, cpu()).unwrap();
    let training = TrainingConfig {
        epochs,
        batch_pedestrians: 40,
        learning_rate_schedule: LearningRateSchedule::Cosine,
        seed: 7,
        ..TrainingConfig::published()
    };
    Trainer::new(network, windows(), None, training).unwrap()
}

fn losses(mut trainer: Trainer) -> Vec<f64> {
    let mut losses = Vec::new();
    while !trainer.is_finished() {
        let epoch = trainer.step().unwrap().finished_epoch;
        losses.extend(epoch.map(|epoch| epoch.loss));
    }
    losses
}

#[test]
fn every_variant_learns() {
    for variant in Variant::ALL {
        let losses = losses(trainer(variant, 25));

        // Because of the noise, the loss of single epochs varies, so the best of the last ones is used.
        let best = losses[17..].iter().copied().fold(f64::INFINITY, f64::min);
        assert!(best < 0.5 * losses[0], "{variant}: {losses:?}");
    }
}

/// Training on paths to goals other than the true endpoints, in the pedestrians' own frames, also with time reversed.
fn path_trainer(epochs: usize, jitter: f64) -> Trainer {
    let config = StarConfig { feed_forward_width: 64, ..StarConfig::recommended(Variant::Full) };
    let training = TrainingConfig {
        epochs,
        batch_pedestrians: 40,
        pedestrians_per_epoch: None,
        seed: 7,
        jitter,
        ..TrainingConfig::recommended(Variant::Full)
    };
    let mut windows = windows();
    windows.extend(windows.clone().iter().map(Window::reversed));
    let aside = |[x, y]: [f64; 2]| [x + 0.3, y - 0.2];
    let goals = windows.iter().map(|window| (0..window.len()).map(|i| aside(window.track(i)[19])).collect()).collect();
    let network = TorchNetwork::new(config, 7, cpu()).unwrap();
    Trainer::new(network, windows, Some(goals), training).unwrap()
}

#[test]
fn paths_to_goals_are_learned() {
    // Exact positions: jitter would add to the loss of so few pedestrians.
    let losses = losses(path_trainer(45, 0.0));
    // Training starts at the neutral motion. Its endpoints are 0.36 m off, like the goals, so the path can follow the
    // true one only in part. Training removes a third of the error.
    let last = losses[44];
    assert!(last < 0.72 * losses[0] && last < 0.22, "{losses:?}");
}

#[test]
fn every_pedestrian_needs_a_goal() {
    let network = TorchNetwork::new(config(Variant::Full), 7, cpu()).unwrap();
    let training = TrainingConfig::recommended(Variant::Full);
    let mut goals: Vec<Vec<_>> = windows().iter().map(|w| vec![[0.0; 2]; w.len()]).collect();
    goals[3].pop();
    let error = Trainer::new(network, windows(), Some(goals), training).unwrap_err();
    assert!(matches!(error, StarError::Network(NetworkError::Shape { .. })), "{error}");
}

fn resumed(trainer: impl Fn() -> Trainer, stop: u64) -> Vec<f32> {
    let folder = tempfile::tempdir().unwrap();
    let state = folder.path().join("optimizer.safetensors");
    let mut first = trainer();
    for _ in 0..stop {
        first.step().unwrap();
    }
    first.save(&Origin::default(), &state).unwrap();
    let mut second = trainer();
    second.resume(&Origin::default(), &state).unwrap();
    trained_to_the_end(second)
}

fn trained_to_the_end(mut trainer: Trainer) -> Vec<f32> {
    while !trainer.is_finished() {
        trainer.step().unwrap();
    }
    trainer.weights().unwrap().numbers().to_vec()
}

#[test]
fn a_run_stopped_anywhere_and_resumed_gives_the_same_weights() {
    let single_steps = || trainer(Variant::Full, 2);
    let total = single_steps().steps().total;
    assert!(total >= 4);
    let expected = trained_to_the_end(single_steps());
    for stop in [1, total / 2 + 1, total - 1] {
        assert_eq!(resumed(single_steps, stop), expected, "stopped at {stop}");
    }
    let walks = || path_trainer(2, 0.06);
    let total = walks().steps().total;
    assert_eq!(resumed(walks, total / 2), trained_to_the_end(walks()));
}
