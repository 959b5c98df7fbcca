//! Parts of batches, and losses that are not finite.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

use super::*;
use crate::device::ComputeDevice;
use ddl_data::{Dataset, WindowRule};
use ddl_network::{DeviceChoice, StarConfig, Variant};
use tch::Kind;

fn state(trainer: &Trainer) -> [Tensor; 3] {
    let adam = &trainer.adam;
    let flat = &trainer.network.parameters().flat;
    [flat, &adam.first_moment, &adam.second_moment].map(|tensor| tensor.detach().copy())
}

/// A trainer by kernels, whose batches have several parts.
fn of_parts(star: &StarConfig, training: &TrainingConfig) -> Trainer {
    let cpu = ComputeDevice::open(DeviceChoice::Cpu).unwrap();
    of_large_batches(star, training, (cpu, Kind::Float))
}

fn of_large_batches(star: &StarConfig, training: &TrainingConfig, (device, kind): (ComputeDevice, Kind)) -> Trainer {
    crate::set_threads(1);
    let star = StarConfig { feed_forward_width: 32, ..star.clone() };
    let network = TorchNetwork::with_precision(star, 5, device, kind).unwrap();
    let windows = Dataset::simulated(1).recordings()[0].windows(WindowRule::Complete);
    let training = TrainingConfig { batch_pedestrians: 3 * PART, ..training.clone() };
    Trainer::new(network, windows, None, training).unwrap()
}

/// The loss of a step and its gradient: those of the kernels and of libtorch in single precision, on the CPU and on a
/// card if there is one, are those of libtorch in double precision on the CPU.
#[test]
fn every_device_gives_the_same_gradients() {
    // First of all: see `ComputeDevice::open`.
    let found = ComputeDevice::open(DeviceChoice::Auto).unwrap();
    let cpu = ComputeDevice::open(DeviceChoice::Cpu).unwrap();
    let published = (StarConfig::published(Variant::Full), TrainingConfig::published(), 1e-5);
    // Rounding grows over a walk of 12 steps.
    let recommended = (StarConfig::recommended(Variant::Full), TrainingConfig::recommended(Variant::Full), 5e-3);
    for (star, training, largest) in [published, recommended] {
        let star = StarConfig { spatial_dropout: 0.0, ..star };
        let training = TrainingConfig { jitter: 0.0, ..training };
        let gradient = |device: ComputeDevice, kind: Kind| {
            let mut trainer = of_large_batches(&star, &training, (device, kind));
            let parts = trainer.batches.batch(0, &trainer.schedule.batches[0]).unwrap();
            let sizes: Vec<usize> = parts.iter().map(|part| part.scenes.pedestrians()).collect();
            let by_kernels = (device, kind) == (cpu, Kind::Float);
            assert_eq!(sizes.len(), if by_kernels { 3 } else { 1 }, "{sizes:?}");
            assert!(sizes.iter().all(|&size| size.abs_diff(sizes[0]) < PART / 2), "{sizes:?}");
            let draw = StepDraw::new(0, &trainer.schedule, &trainer.config, &trainer.network).unwrap();
            // A card computes twice, then records the step and replays it.
            let visits = (0..4).map(|_| {
                let (loss, gradient) = trainer.gradient(0, &draw).unwrap();
                let gradient = gradient.to_device(tch::Device::Cpu).to_kind(Kind::Double);
                (loss.double_value(&[]), gradient)
            });
            visits.collect::<Vec<_>>()
        };
        let (expected, whole) = gradient(cpu, Kind::Double).remove(0);
        let size = whole.abs().max().double_value(&[]);
        for device in [cpu, found] {
            for (loss, gradient) in gradient(device, Kind::Float) {
                let loss = (loss / expected - 1.0).abs();
                let error = (gradient - &whole).abs().max().double_value(&[]) / size;
                assert!(loss < 1e-5 && error < largest, "{}: {loss} {error}", device.name());
            }
        }
    }
}

#[test]
fn the_number_of_threads_changes_nothing() {
    let [published, recommended] = [StarConfig::published, StarConfig::recommended].map(|star| star(Variant::Full));
    for (star, training) in
        [(published, TrainingConfig::published()), (recommended, TrainingConfig::recommended(Variant::Full))]
    {
        let after = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| {
                let mut trainer = of_parts(&star, &training);
                for _ in 0..3 {
                    trainer.step().unwrap();
                }
                state(&trainer)
            })
        };
        assert_eq!(after(1), after(3));
    }
}

/// In single precision, such coordinates are rounded to half a metre.
#[test]
fn in_coordinates_of_maps_the_gradient_is_the_same() {
    let cpu = ComputeDevice::open(DeviceChoice::Cpu).unwrap();
    let gradient = |by: Position| {
        let star = StarConfig { feed_forward_width: 32, ..StarConfig::published(Variant::Full) };
        let network = TorchNetwork::with_precision(star, 5, cpu, Kind::Float).unwrap();
        let moved = |place: Position| [place[0] + by[0], place[1] + by[1]];
        let windows = Dataset::simulated(1).recordings()[0].windows(WindowRule::Complete);
        let windows: Vec<Window> = windows.iter().map(|window| window.map_positions(|_, _, at| moved(at))).collect();
        let end = |window: &Window| (0..window.len()).map(|i| window.future(i)[11]).collect();
        let goals = windows.iter().map(end).collect();
        let mut trainer = Trainer::new(network, windows, Some(goals), TrainingConfig::published()).unwrap();
        let draw = StepDraw::new(0, &trainer.schedule, &trainer.config, &trainer.network).unwrap();
        trainer.gradient(0, &draw).unwrap().1.to_kind(Kind::Double)
    };
    let (near, far) = (gradient([0.0; 2]), gradient([691_608.0, 5_334_763.0]));
    let apart = ((&near - far).norm() / near.norm()).double_value(&[]);
    assert!(apart < 1e-3, "{apart}");
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
        let [mut trainer, mut undisturbed] = [0; 2].map(|_| of_parts(&star, &TrainingConfig::published()));
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
