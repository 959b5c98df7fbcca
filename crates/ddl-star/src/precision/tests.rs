//! Where bf16 counts, and where it is refused.
#![allow(clippy::unwrap_used, reason = "a test may panic")]

use super::*;
use crate::{
    ComputeDevice, DeviceChoice, Mode, NoiseInput, SceneBatch, StarConfig, StarNetwork, Trainer,
    TrainingConfig, Variant,
};
use ddl_data::{Dataset, WINDOW, Window, WindowRule};
use tch::{Kind, Tensor};

fn network(kind: Kind) -> StarNetwork {
    let config = StarConfig {
        feed_forward_width: 96,
        ..StarConfig::published(Variant::Full)
    };
    let cpu = ComputeDevice::open(DeviceChoice::Cpu).unwrap();
    StarNetwork::with_precision(config, 3, cpu, kind).unwrap()
}

fn windows() -> Vec<Window> {
    let windows = Dataset::simulated(1).recordings()[0].windows(WindowRule::Complete);
    windows.into_iter().take(4).collect()
}

fn one_step_ahead(network: &StarNetwork) -> Tensor {
    let windows = windows();
    let (device, kind) = (network.device(), network.kind());
    let windows = windows.iter().collect::<Vec<_>>();
    let batch = SceneBatch::new(&windows, WINDOW, WINDOW - 1, 2.0, device, kind).unwrap();
    let goals = batch.positions().get(WINDOW as i64 - 1);
    network.teacher_forced(&batch, &goals, &NoiseInput::Expected, Mode::Evaluate)
}

/// The weights are packed again for every precision, and gradients are libtorch's.
#[test]
fn it_counts_where_nobody_wants_gradients() {
    let mut network = network(Kind::Float);
    let [mut forecasts, mut with_gradients] = [Vec::new(), Vec::new()];
    for precision in [Precision::F32, Precision::Bf16, Precision::F32] {
        network = network.in_precision(precision).unwrap();
        assert_eq!(network.precision(), precision);
        with_gradients.push(one_step_ahead(&network).detach());
        forecasts.push(tch::no_grad(|| one_step_ahead(&network)));
    }
    assert_eq!(with_gradients[0], with_gradients[1]);
    assert_eq!(forecasts[0], forecasts[2]);
    let difference = (&forecasts[0] - &forecasts[1]).abs().max();
    let difference = difference.double_value(&[]);
    assert!(difference > 1e-7 && difference < 0.05, "{difference} m");
}

#[test]
fn it_is_refused_in_double_precision_and_in_training() {
    let error = network(Kind::Double).in_precision(Precision::Bf16);
    assert!(error.unwrap_err().to_string().contains("on the CPU"));
    let network = network(Kind::Float).in_precision(Precision::Bf16).unwrap();
    let error = Trainer::new(network, windows(), TrainingConfig::published());
    assert!(error.unwrap_err().to_string().contains("f32 in training"));
}

#[test]
fn names_are_read() {
    for precision in [Precision::F32, Precision::Bf16] {
        assert_eq!(precision.name().parse::<Precision>().unwrap(), precision);
    }
    let error = "f16".parse::<Precision>().unwrap_err().to_string();
    assert!(error.contains("f16") && error.contains("bf16"), "{error}");
}
