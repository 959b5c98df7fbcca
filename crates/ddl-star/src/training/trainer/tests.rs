//! Parts of batches, and states that are refused.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

use super::*;
use crate::device::ComputeDevice;
use ddl_data::{Dataset, WindowRule};
use ddl_network::{DeviceChoice, StarConfig, Variant};
use tch::Kind;

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
    Trainer::new(network, windows, None, training).unwrap()
}

#[test]
fn the_gradients_of_parts_add_up_to_that_of_the_batch() {
    let star = StarConfig {
        spatial_dropout: 0.0,
        ..StarConfig::published(Variant::Full)
    };
    let gradient = |kind: Kind| {
        let trainer = of_parts(&star, &TrainingConfig::published(), kind);
        let parts = trainer.batches.batch(0, trainer.schedule.batch(0)).unwrap();
        let sizes: Vec<usize> = parts.iter().map(|part| part.scenes.pedestrians()).collect();
        assert_eq!(sizes.len(), if kind == Kind::Float { 3 } else { 1 }, "{sizes:?}");
        assert!(
            sizes.iter().all(|&size| size.abs_diff(sizes[0]) < PART / 2),
            "{sizes:?}"
        );
        let draw = StepDraw::new(0, &trainer.schedule, &trainer.config, &trainer.network).unwrap();
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
fn an_impossible_state_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("state.safetensors");
    let training = TrainingConfig {
        epochs: 2,
        pedestrians_per_epoch: Some(7 * 3 * PART),
        ..TrainingConfig::published()
    };
    let trainer = || of_parts(&StarConfig::published(Variant::Full), &training, Kind::Float);
    let refused = |spoil: &dyn Fn(&mut Trainer), words: &str| {
        let mut spoilt = trainer();
        spoilt.step().unwrap();
        spoil(&mut spoilt);
        spoilt.save(&Origin::default(), &path).unwrap();
        let mut other = trainer();
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

#[test]
fn a_loss_that_is_not_finite_stops_the_run_and_names_the_batch() {
    let star = StarConfig::published(Variant::Full);
    // NaN at the end of the network, and at its beginning, from which it must pass through the kernels.
    for bias in [
        "output_layer.bias",
        "input_embedding_layer_temporal.bias",
        "input_embedding_layer_spatial.bias",
        "fusion_layer.bias",
    ] {
        let [mut trainer, mut undisturbed] = [0; 2].map(|_| of_parts(&star, &TrainingConfig::published(), Kind::Float));
        let _guard = tch::no_grad_guard();
        let mut bias = trainer.network.parameters().get(bias).unwrap().shallow_clone();
        let before = bias.copy();
        let _ = bias.fill_(f64::NAN);
        let error = tch::with_grad(|| trainer.step()).unwrap_err();
        assert!(matches!(error, StarError::NonFinite { .. }), "{error}");
        let said = error.to_string();
        assert!(said.contains("epoch 1, batch 0") && said.contains('@'), "{said}");
        // Nothing else has changed.
        bias.copy_(&before);
        let again = tch::with_grad(|| [&mut trainer, &mut undisturbed].map(|trainer| trainer.step().unwrap().loss));
        assert!(again[0].to_bits() == again[1].to_bits(), "{again:?}");
        assert_eq!(state(&trainer), state(&undisturbed));
    }
}
