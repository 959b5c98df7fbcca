//! Kernels and tape against libtorch.
#![allow(clippy::unwrap_used, reason = "a test may panic")]

use super::*;
use crate::batch::SceneBatch;
use crate::config::{StarConfig, Variant};
use crate::device::{ComputeDevice, DeviceChoice};
use crate::emission::NoiseInput;
use crate::flow::StepRule;
use crate::loss::{mean_distance, mean_squared_distance};
use crate::star::StarNetwork;
use ddl_data::{Dataset, WINDOW, Window, WindowRule};

/// Windows of very different numbers of walkers, a lone one among them, or that one alone.
fn batches(kind: Kind) -> Vec<SceneBatch> {
    let dataset = Dataset::simulated(1);
    let windows = dataset.recordings()[0].windows(WindowRule::Complete);
    let some: Vec<&Window> = windows.iter().step_by(9).take(4).collect();
    let alone = Window::new(
        "alone",
        0,
        10,
        windows[0].pedestrians()[..1].to_vec(),
        vec![windows[0].track(0).to_vec()],
    )
    .unwrap();
    let many = some.iter().copied().chain([&alone]).collect();
    let batch = |windows: &Vec<&Window>| {
        SceneBatch::new(windows, WINDOW, WINDOW - 1, 2.0, tch::Device::Cpu, kind).unwrap()
    };
    [some, many, vec![&alone]].iter().map(batch).collect()
}

/// Loss and gradient of a whole teacher-forced pass: through kernels and tape as libtorch alone has them in
/// double precision.
#[test]
fn kernels_and_tape_give_the_gradients_of_libtorch() {
    let cpu = ComputeDevice::open(DeviceChoice::Cpu).unwrap();
    for (variant, scenes) in Variant::ALL
        .into_iter()
        .flat_map(|variant| [(variant, 0), (variant, 1), (variant, 2)])
    {
        let config = StarConfig {
            feed_forward_width: 96,
            ..StarConfig::published(variant)
        };
        let gradient = |kind: Kind, plain: bool| {
            let network = StarNetwork::with_precision(config.clone(), 3, cpu, kind).unwrap();
            let pass = if plain {
                Pass::plain(Mode::Evaluate)
            } else {
                Pass::training(Mode::Evaluate, 0, network.parameters())
            };
            assert_eq!(pass.has_kernels(), kind == Kind::Float);
            let batch = &batches(kind)[scenes];
            let noise = NoiseInput::Draws(Tensor::ones([1, 16], (kind, tch::Device::Cpu)) * 0.3);
            let goals = batch.positions().get(WINDOW as i64 - 1);
            let forecast = network.teacher_forced_in(batch, &goals, &noise, &pass);
            let truth = batch.positions().narrow(0, 1, WINDOW as i64 - 1);
            let loss = mean_squared_distance(&forecast, &truth);
            let gradient = pass.gradient(&loss, network.parameters()).unwrap();
            (loss.double_value(&[]), gradient.to_kind(Kind::Double))
        };
        let (loss, ours) = gradient(Kind::Float, false);
        let (known_loss, known) = gradient(Kind::Double, true);
        // On CUDA, as in double precision: no kernels, and weights shared by all their uses.
        let (_, shared) = gradient(Kind::Double, false);
        let difference = (shared - &known).norm().double_value(&[]);
        assert!(difference < 1e-12 * known.norm().double_value(&[]));
        assert!(
            (loss / known_loss - 1.0).abs() < 1e-5,
            "{variant}: {loss} {known_loss}"
        );
        let difference = (&ours - &known).norm().double_value(&[]);
        let size = known.norm().double_value(&[]);
        assert!(
            difference < 1e-4 * size,
            "{variant}: {difference} of {size}"
        );
    }
}

/// The networks of all variants, and those in the walkers' own frames.
fn configs() -> Vec<StarConfig> {
    let own = [Variant::NoDynamics, Variant::Full].map(StarConfig::recommended);
    let world = Variant::ALL.map(StarConfig::published);
    let narrow = |config| StarConfig {
        feed_forward_width: 96,
        ..config
    };
    world.into_iter().chain(own).map(narrow).collect()
}

/// Loss and gradient of a whole walk, whose own positions are read again: through kernels and tape as libtorch alone has
/// them in double precision.
#[test]
fn kernels_and_tape_give_the_gradients_of_a_walk() {
    let cpu = ComputeDevice::open(DeviceChoice::Cpu).unwrap();
    for (config, scenes) in configs()
        .iter()
        .flat_map(|config| [(config, 0), (config, 1)])
    {
        let gradient = |kind: Kind, plain: bool| {
            let network = StarNetwork::with_precision(config.clone(), 3, cpu, kind).unwrap();
            let pass = if plain {
                Pass::plain(Mode::Evaluate)
            } else {
                Pass::training(Mode::Evaluate, 0, network.parameters())
            };
            let batch = &batches(kind)[scenes];
            let goals = batch.positions().narrow(0, WINDOW as i64 - 1, 1) + 0.3;
            let steps = (12, StepRule::Bounded);
            let walk = network.roll_out_in(batch, &goals, &NoiseInput::Expected, steps, &pass);
            let truth = batch.positions().narrow(0, 8, 12);
            let loss = mean_distance(&walk.positions.squeeze_dim(1), &truth);
            let gradient = pass.gradient(&loss, network.parameters()).unwrap();
            (loss.double_value(&[]), gradient.to_kind(Kind::Double))
        };
        let (loss, ours) = gradient(Kind::Float, false);
        let (known_loss, known) = gradient(Kind::Double, true);
        let name = format!("{} {:?}", config.variant, config.frame);
        assert!(
            (loss / known_loss - 1.0).abs() < 1e-4,
            "{name}: {loss} {known_loss}"
        );
        let difference = (&ours - &known).norm().double_value(&[]);
        let size = known.norm().double_value(&[]);
        assert!(
            size > 1e-3 && difference < 5e-3 * size,
            "{name}: {difference} of {size}"
        );
    }
}

/// Positions and factors of forecasts, with several goals or several noise vectors, by kernels as libtorch has them in
/// double precision; kernels see that weights have changed.
#[test]
fn kernels_give_the_forecasts_of_libtorch() {
    let cpu = ComputeDevice::open(DeviceChoice::Cpu).unwrap();
    for config in configs() {
        let variant = config.variant;
        let of = |kind: Kind, several_goals: bool| -> Vec<Tensor> {
            let network = StarNetwork::with_precision(config.clone(), 3, cpu, kind).unwrap();
            assert!(!network.pass(Mode::Evaluate).has_kernels(), "{kind:?}");
            let _guard = tch::no_grad_guard();
            let kernels = network.pass(Mode::Evaluate).has_kernels();
            assert_eq!(kernels, kind == Kind::Float);
            let options = (kind, tch::Device::Cpu);
            let mut forecasts = Vec::new();
            for batch in batches(kind) {
                let end = batch.positions().get(WINDOW as i64 - 1);
                let wave = |count: i64, width: i64| {
                    let angles = Tensor::arange(count * width, options);
                    angles.sin().reshape([count, 1, width])
                };
                let (goals, noise) = if several_goals {
                    (&end + wave(3, 2), NoiseInput::Expected)
                } else {
                    (
                        end.unsqueeze(0),
                        NoiseInput::Draws(wave(3, 16).squeeze_dim(1)),
                    )
                };
                for _ in 0..2 {
                    let rollout = network.roll_out(&batch, &goals, &noise, 12, StepRule::Bounded);
                    assert_eq!(rollout.positions.size()[1], 3);
                    forecasts.push(rollout.positions);
                    forecasts.extend(rollout.factors);
                    let mut weight = network
                        .parameters()
                        .iter()
                        .next()
                        .unwrap()
                        .1
                        .shallow_clone();
                    weight *= 1.5;
                }
            }
            forecasts
        };
        for several_goals in [false, true] {
            let ours = of(Kind::Float, several_goals);
            let known = of(Kind::Double, several_goals);
            for (ours, known) in ours.iter().zip(&known) {
                let difference = (ours - known).abs().max().double_value(&[]);
                assert!(difference < 2e-3, "{variant}: {difference}");
            }
            let change = (&known[0] - &known[known.len() / 6]).abs().max();
            assert!(change.double_value(&[]) > 2e-2, "{variant}: {change}");
        }
    }
}

#[test]
fn every_dropout_has_a_seed_of_its_own() {
    let config = StarConfig::published(Variant::Full);
    let cpu = ComputeDevice::open(DeviceChoice::Cpu).unwrap();
    let network = StarNetwork::new(config, 1, cpu).unwrap();
    let pass = Pass::training(Mode::Train, 7, network.parameters());
    let seeds: Vec<u64> = (0..100)
        .filter_map(|_| pass.dropout(0.1))
        .map(|dropout| dropout.seed)
        .collect();
    let mut distinct = seeds.clone();
    distinct.sort_unstable();
    distinct.dedup();
    assert_eq!((seeds.len(), distinct.len()), (100, 100));
    assert!(pass.dropout(0.0).is_none());
    assert!(Pass::plain(Mode::Evaluate).dropout(0.1).is_none());
}
