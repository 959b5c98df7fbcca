//! Agreement with the published network: weights by formula, outputs of the published code in f64 on a CPU
//! (`reference/star_ddl_forward.json`).

#![allow(clippy::unwrap_used, reason = "a test may panic")]

use crate::device::ComputeDevice;
use crate::model::{NoiseInput, TensorEngine, TorchBackend, TorchNetwork, WindowBatch};
use crate::training::mean_squared_distance;
use ddl_core::{PedestrianId, Window};
use ddl_network::backend::Mode;
use ddl_network::{DeviceChoice, StarConfig, StepRule, Variant};
use serde_json::Value;
use tch::{Device, Kind, Tensor};

struct PublishedNumbers(Value);

impl PublishedNumbers {
    fn load() -> Self {
        Self(serde_json::from_str(include_str!("../../tests/reference/star_ddl_forward.json")).unwrap())
    }

    fn numbers(&self, pointer: &str) -> Vec<f64> {
        fn collect(value: &Value, into: &mut Vec<f64>) {
            match value {
                Value::Array(items) => items.iter().for_each(|item| collect(item, into)),
                other => into.push(other.as_f64().unwrap()),
            }
        }
        let mut numbers = Vec::new();
        collect(self.0.pointer(pointer).unwrap(), &mut numbers);
        numbers
    }

    fn tensor(&self, pointer: &str, shape: &[i64], kind: Kind) -> Tensor {
        Tensor::from_slice(&self.numbers(pointer)).reshape(shape).to_kind(kind)
    }

    fn windows(&self) -> Vec<Window> {
        let positions = self.numbers("/positions");
        let pedestrians = positions.len() / 40;
        let mut first = 0;
        self.numbers("/scene_sizes")
            .into_iter()
            .map(|size| {
                let members = first..first + size as usize;
                first = members.end;
                let track = |i: usize| -> Vec<[f64; 2]> {
                    (0..20)
                        .map(|t| {
                            let start = 2 * (t * pedestrians + i);
                            [positions[start], positions[start + 1]]
                        })
                        .collect()
                };
                let ids = members.clone().map(|i| PedestrianId(i as i64)).collect();
                Window::new("reference", 0, 10, ids, members.map(track).collect()).unwrap()
            })
            .collect()
    }

    fn network(&self, kind: Kind) -> TorchNetwork {
        let cpu = ComputeDevice::open(DeviceChoice::Cpu).unwrap();
        let config = StarConfig::published(Variant::Full);
        let network = TorchNetwork::with_precision(config, 1, cpu, kind).unwrap();
        let mut set = 0;
        for entry in self.0["weights"]["tensors"].as_array().unwrap() {
            let name = entry["name"].as_str().unwrap();
            if name.starts_with("temporal_encoder_layer.") {
                continue; // the published template layer never runs
            }
            let index = entry["index"].as_f64().unwrap();
            let shape: Vec<i64> = serde_json::from_value(entry["shape"].clone()).unwrap();
            let scale = if shape.len() == 2 { 0.3 / (shape[1] as f64).sqrt() } else { 0.05 };
            let shift = if name.contains("norm") && name.ends_with("weight") { 1.0 } else { 0.0 };
            let values: Vec<f64> = (0..shape.iter().product())
                .map(|k: i64| {
                    let phase = 0.37 * k as f64 + 1.3 * index + 0.11 * (k % 7) as f64;
                    shift + scale * phase.sin()
                })
                .collect();
            let _guard = tch::no_grad_guard();
            let target = network.parameters().get(name).unwrap_or_else(|| panic!("no {name}"));
            assert_eq!(target.size(), shape, "{name}");
            target.shallow_clone().copy_(&Tensor::from_slice(&values).reshape(&shape));
            set += 1;
        }
        assert_eq!(set, network.parameters().iter().count());
        assert_eq!(network.parameters().layout().count(), 827_443);
        network
    }

    fn batch(&self, kind: Kind) -> WindowBatch {
        let windows = self.windows();
        let views: Vec<&Window> = windows.iter().collect();
        WindowBatch::new(&views, 20, 19, 10.0, Device::Cpu, kind).unwrap()
    }
}

fn largest_difference(a: &Tensor, b: &Tensor) -> f64 {
    assert_eq!(a.size(), b.size());
    (a - b).abs().max().double_value(&[])
}

fn agrees(kind: Kind, tolerance: f64) {
    let reference = PublishedNumbers::load();
    let network = reference.network(kind);
    let batch = reference.batch(kind);
    let pedestrians = batch.pedestrians() as i64;
    let noise = NoiseInput::Draws(reference.tensor("/noise", &[1, 16], kind));

    let torch = TorchBackend::new(network.parameters(), Mode::Evaluate);
    let goal = reference.tensor("/true_goal", &[pedestrians, 2], kind);
    let forecast = network.layers.teacher_forced(&batch, &goal, &noise, TensorEngine::Torch(&torch));
    let expected = reference.tensor("/train_forward/positions", &[19, pedestrians, 2], kind);
    let difference = largest_difference(&forecast, &expected);
    assert!(difference < tolerance, "teacher-forced positions differ by {difference}");

    let loss = mean_squared_distance(&forecast, &batch.positions.narrow(0, 1, 19));
    let expected = reference.numbers("/train_forward/loss")[0];
    let relative = (loss.double_value(&[]) / expected - 1.0).abs();
    assert!(relative < 1e-3, "loss differs by {relative}");
    loss.backward();
    for (name, tensor) in network.parameters().iter() {
        let expected = reference.0["train_forward"]["grad_norms"][name].as_f64().unwrap();
        let norm = tensor.grad().norm().double_value(&[]);
        assert!((norm / expected - 1.0).abs() < 1e-3, "gradient of {name}: {norm}, not {expected}");
    }

    let goal = reference.tensor("/estimated_goal", &[1, pedestrians, 2], kind);
    let _guard = tch::no_grad_guard();
    let rollout = network.layers.roll_out(&batch, &goal, &noise, StepRule::Euler, TensorEngine::Torch(&torch));
    let rolled = rollout.positions.squeeze_dim(1);
    let expected = reference.tensor("/test_forward/positions", &[19, pedestrians, 2], kind);
    let difference = largest_difference(&rolled, &expected.narrow(0, 7, 12));
    assert!(difference < tolerance, "rolled-out positions differ by {difference}");
}

#[test]
fn agrees_with_the_published_network_in_double_precision() {
    agrees(Kind::Double, 1e-9);
}

#[test]
fn agrees_with_the_published_network_in_single_precision() {
    agrees(Kind::Float, 2e-4);
}
