//! Training whose losses are read at intervals, as on CUDA.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

use super::*;
use crate::device::ComputeDevice;
use ddl_data::{Dataset, WindowRule};
use ddl_network::{DeviceChoice, StarConfig, Variant};
use tch::Kind;

fn trainer(kind: Kind, read_every: usize) -> Trainer {
    crate::set_threads(1);
    let config = StarConfig {
        feed_forward_width: 32,
        ..StarConfig::published(Variant::Full)
    };
    let cpu = ComputeDevice::open(DeviceChoice::Cpu).unwrap();
    let network = TorchNetwork::with_precision(config, 5, cpu, kind).unwrap();
    let windows = Dataset::simulated(1).recordings()[0].windows(WindowRule::Complete);
    let training = TrainingConfig {
        epochs: 2,
        batch_pedestrians: 10,
        pedestrians_per_epoch: Some(70),
        seed: 5,
        ..TrainingConfig::published()
    };
    let windows = windows.into_iter().take(40).collect();
    let mut trainer = Trainer::new(network, windows, training).unwrap();
    assert_eq!(trainer.schedule.steps_per_epoch(), 7);
    trainer.read_every = read_every;
    trainer
}

fn state(trainer: &Trainer) -> [Tensor; 3] {
    let adam = &trainer.adam;
    let flat = trainer.network.parameters().flat();
    [flat, &adam.first_moment, &adam.second_moment].map(|tensor| tensor.detach().copy())
}

/// A trainer whose batches have several parts.
fn of_parts(star: &StarConfig, training: &TrainingConfig, kind: Kind) -> Trainer {
    crate::set_threads(1);
    let star = StarConfig {
        feed_forward_width: 32,
        ..star.clone()
    };
    let cpu = ComputeDevice::open(DeviceChoice::Cpu).unwrap();
    let network = TorchNetwork::with_precision(star, 5, cpu, kind).unwrap();
    let windows = Dataset::simulated(1).recordings()[0].windows(WindowRule::Complete);
    let training = TrainingConfig {
        batch_pedestrians: 3 * PART,
        ..training.clone()
    };
    Trainer::new(network, windows, training).unwrap()
}

#[test]
fn the_gradients_of_parts_add_up_to_that_of_the_batch() {
    let star = StarConfig {
        spatial_dropout: 0.0,
        ..StarConfig::published(Variant::Full)
    };
    let gradient = |kind: Kind| {
        let mut trainer = of_parts(&star, &TrainingConfig::published(), kind);
        let parts = trainer.batches.batch(0, trainer.schedule.batch(0)).unwrap();
        let sizes: Vec<usize> = parts.iter().map(|part| part.scenes.pedestrians()).collect();
        assert_eq!(sizes.len(), if kind == Kind::Float { 3 } else { 1 }, "{sizes:?}");
        assert!(
            sizes.iter().all(|&size| size.abs_diff(sizes[0]) < PART / 2),
            "{sizes:?}"
        );
        let draw = trainer.draw(0).unwrap();
        let (loss, gradient) = trainer.gradient(0, &draw).unwrap();
        (loss.double_value(&[]), gradient.to_kind(Kind::Double))
    };
    let ((loss, gradient), (whole_loss, whole)) = (gradient(Kind::Float), gradient(Kind::Double));
    assert!((loss - whole_loss).abs() < 1e-5 * whole_loss, "{loss} {whole_loss}");
    let largest = |tensor: Tensor| tensor.abs().max().double_value(&[]);
    let (error, size) = (largest(gradient - &whole), largest(whole));
    assert!(error < 1e-5 * size, "{error} of {size}");
}

#[test]
fn the_number_of_threads_changes_nothing() {
    let [published, recommended] = [StarConfig::published, StarConfig::recommended].map(|star| star(Variant::Full));
    for (star, training) in [
        (published, TrainingConfig::published()),
        (recommended, TrainingConfig::recommended(Variant::Full)),
    ] {
        let after = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| {
                let mut trainer = of_parts(&star, &training, Kind::Float);
                for _ in 0..3 {
                    trainer.step().unwrap();
                }
                state(&trainer)
            })
        };
        assert_eq!(after(1), after(3));
    }
}

#[test]
fn a_run_with_parts_and_jitter_resumes_with_the_same_bits() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("state.safetensors");
    let star = StarConfig::recommended(Variant::Full);
    let training = TrainingConfig::recommended(Variant::Full);
    assert!(training.jitter > 0.0);
    let trainer = || of_parts(&star, &training, Kind::Float);
    let (mut whole, mut resumed) = (trainer(), trainer());
    whole.step().unwrap();
    whole.save(&Origin::default(), &path).unwrap();
    whole.step().unwrap();
    resumed.resume(&Origin::default(), &path).unwrap();
    resumed.step().unwrap();
    assert_eq!(state(&resumed), state(&whole));
}

#[test]
fn the_interval_of_reading_losses_changes_nothing() {
    for kind in [Kind::Float, Kind::Double] {
        let mut every = trainer(kind, 1);
        let mut some = trainer(kind, 4);
        let mut losses = Vec::new();
        let steps = every.schedule.steps_per_epoch();
        for done in 1..=steps {
            let (one, other) = (every.step().unwrap(), some.step().unwrap());
            losses.push(one.loss.unwrap());
            let read = done % 4 == 0 || done == steps;
            assert_eq!(other.loss.is_some(), read, "step {done} of {steps}");
            if let Some(mean) = other.loss {
                let expected = losses.iter().sum::<f64>() / losses.len() as f64;
                assert!((mean - expected).abs() < 1e-12, "{mean} {expected}");
                losses.clear();
            }
            let of_epoch = |report: &StepReport| report.finished_epoch.as_ref().map(|e| e.loss);
            assert_eq!(of_epoch(&one), of_epoch(&other));
        }
        assert_eq!(state(&every), state(&some));
    }
}

#[test]
fn a_bad_step_is_reported_later_and_later_steps_do_not_count() {
    for kind in [Kind::Float, Kind::Double] {
        let mut undisturbed = trainer(kind, 1);
        for _ in 0..2 {
            undisturbed.step().unwrap();
        }
        let mut trainer = trainer(kind, 5);
        trainer.step().unwrap();
        trainer.draws.as_mut().unwrap().spoil(2);
        for _ in 0..3 {
            assert_eq!(trainer.step().unwrap().loss, None);
        }
        let error = trainer.step().unwrap_err();
        let StarError::NonFinite { epoch, batch, .. } = error else {
            panic!("{error}")
        };
        assert_eq!((epoch, batch), (1, trainer.schedule.batch_index(2)));
        let first = trainer.schedule.batch(batch)[0];
        let window = trainer.batches.window(first);
        let named = format!("{}@{}", window.recording(), window.start_frame());
        assert!(error.to_string().contains(&named), "{error}");
        assert_eq!(state(&trainer), state(&undisturbed));
        assert_eq!(trainer.steps(), undisturbed.steps());
        assert!((trainer.progress.loss_sum - undisturbed.progress.loss_sum).abs() < 1e-15);

        // New draws make the step finite.
        trainer.draws = None;
        trainer.read_every = 1;
        assert_eq!(trainer.step().unwrap().loss, undisturbed.step().unwrap().loss);
        assert_eq!(state(&trainer), state(&undisturbed));
    }
}

#[test]
fn saving_reads_unread_losses() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("state.safetensors");
    let (mut every, mut some) = (trainer(Kind::Float, 1), trainer(Kind::Float, 16));
    for _ in 0..3 {
        every.step().unwrap();
        some.step().unwrap();
    }
    some.save(&Origin::default(), &path).unwrap();
    let mut resumed = trainer(Kind::Float, 16);
    resumed.resume(&Origin::default(), &path).unwrap();
    let bits = |trainer: &Trainer| trainer.progress.loss_sum.to_bits();
    assert_eq!(bits(&resumed), bits(&every));
    assert_eq!(resumed.steps(), every.steps());
    assert_eq!(state(&resumed), state(&every));

    some.draws.as_mut().unwrap().spoil(3);
    some.step().unwrap();
    assert!(matches!(
        some.save(&Origin::default(), &path),
        Err(StarError::NonFinite { .. })
    ));
}

#[test]
fn an_impossible_state_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("state.safetensors");
    let refused = |spoil: &dyn Fn(&mut Trainer), words: &str| {
        let mut spoilt = trainer(Kind::Float, 1);
        spoilt.step().unwrap();
        spoil(&mut spoilt);
        spoilt.save(&Origin::default(), &path).unwrap();
        let mut other = trainer(Kind::Float, 1);
        let before = state(&other);
        let error = other.resume(&Origin::default(), &path).unwrap_err();
        assert!(error.to_string().contains(words), "{error}");
        assert_eq!(state(&other), before);
    };
    refused(
        &|trainer| {
            let _guard = tch::no_grad_guard();
            let _ = trainer.adam.second_moment.get(0).fill_(-1.0);
        },
        "negative",
    );
    refused(&|trainer| trainer.progress.steps = 15, "0..=14");
    refused(&|trainer| trainer.progress.steps = u64::MAX, "0..=14");
}
