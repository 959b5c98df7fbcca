//! A custom backbone: trained on libtorch, forecast by kernels.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

use ddl_core::{OBSERVED, Window};
use ddl_data::{Dataset, WindowRule};
use ddl_network::backbone::{Backbone, output_layer};
use ddl_network::backend::{Backend, Memory};
use ddl_network::weights::{EncoderLayer, Layout, Linear, Sizes, Weights};
use ddl_network::{
    DeviceChoice, MotionNetwork, NetworkError, NetworkFrame, Noise, StarConfig, StepRule, TrainingConfig, Variant,
};
use ddl_network::{ForecastWindows, WindowRollout};
use ddl_star::{ComputeDevice, TorchNetwork, Trainer};
use tch::Kind;

#[derive(Debug, Clone)]
struct Recurrent {
    first: Linear,
    later: Linear,
    neighbours: EncoderLayer,
    output: Linear,
}

impl Recurrent {
    fn new(layout: &mut Layout, config: &StarConfig) -> Self {
        assert_eq!(config.frame, NetworkFrame::Goal);
        let [inputs, width, hidden] =
            [config.temporal_inputs() + 2, config.model_width, config.feed_forward_width].map(|n| n as usize);
        let sizes = Sizes { width, heads: config.heads as usize, hidden };
        Self {
            first: layout.linear("first_layer", inputs, width),
            later: layout.linear("later_layer", inputs + width, width),
            neighbours: layout.encoder_layer("neighbours", sizes, config.spatial_dropout),
            output: output_layer(layout, config),
        }
    }
}

impl<B: Backend> Backbone<B> for Recurrent {
    fn output(&self) -> Linear {
        self.output
    }

    fn scene(&self, _: &B, centred: &B::Tokens, _: &B::Seen) -> B::Tokens {
        centred.clone()
    }

    fn step(
        &self,
        backend: &B,
        memory: &mut Memory<B>,
        relative: &B::Tokens,
        scene: &B::Tokens,
        seen: &B::Seen,
    ) -> B::Tokens {
        let scene = backend.repeated(scene, backend.entries(relative));
        let inputs = backend.concatenate(relative, &scene);
        let state = match memory.tokens.pop() {
            None => backend.linear(self.first, &inputs),
            Some(state) => {
                let state = backend.repeated(&state, backend.entries(relative));
                backend.linear(self.later, &backend.concatenate(&inputs, &state))
            }
        };
        let state = backend.spatial_attention(self.neighbours, &backend.relu(&state), seen);
        memory.tokens.push(state.clone());
        backend.concatenate(&state, relative)
    }
}

fn config() -> StarConfig {
    StarConfig { model_width: 16, heads: 4, feed_forward_width: 32, ..StarConfig::recommended(Variant::Full) }
}

fn windows() -> Vec<Window> {
    Dataset::simulated(1).recordings()[0].windows(WindowRule::Complete).into_iter().take(24).collect()
}

fn torch(kind: Kind) -> TorchNetwork {
    ddl_star::set_threads(1);
    let cpu = ComputeDevice::open(DeviceChoice::Cpu).unwrap();
    TorchNetwork::with_backbone(config(), 7, cpu, kind, Recurrent::new).unwrap()
}

fn forecasts(network: &dyn ForecastWindows) -> Result<Vec<WindowRollout>, NetworkError> {
    let windows: Vec<Window> = windows().iter().map(Window::without_future).collect();
    let around = |[x, y]: [f64; 2]| vec![[x + 3.0, y], [x, y - 2.0], [x - 0.5, y + 0.1]];
    let of_window = |window: &Window| -> Vec<Vec<[f64; 2]>> {
        let last = |i: usize| window.observed(i)[OBSERVED - 1];
        (0..window.len()).map(|i| around(last(i))).collect()
    };
    let goals: Vec<_> = windows.iter().map(of_window).collect();
    network.forecast_windows(&windows, &goals, Noise::Expected, StepRule::Bounded, None)
}

#[test]
fn a_custom_backbone_is_trained_and_forecasts_without_libtorch() {
    let training = TrainingConfig {
        epochs: 25,
        batch_pedestrians: 40,
        pedestrians_per_epoch: None,
        seed: 7,
        jitter: 0.0,
        ..TrainingConfig::recommended(Variant::Full)
    };
    let mut trainer = Trainer::new(torch(Kind::Float), windows(), None, training).unwrap();
    let mut losses = Vec::new();
    while !trainer.is_finished() {
        let epoch = trainer.step().unwrap().finished_epoch;
        losses.extend(epoch.map(|epoch| epoch.loss));
    }
    assert!(losses[24] < 0.8 * losses[0], "{losses:?}");

    let weights = trainer.weights().unwrap();
    let exact = torch(Kind::Double);
    exact.parameters().set(&weights).unwrap();
    let untrained = MotionNetwork::with_backbone(config(), Recurrent::new, |layout| Ok(Weights::seeded(layout, 7)));
    let untrained = untrained.unwrap();
    let before = forecasts(&untrained).unwrap();
    let plain = MotionNetwork::with_backbone(config(), Recurrent::new, |_| Ok(weights)).unwrap();
    let ours = forecasts(&plain).unwrap();
    let apart = |ours: &[WindowRollout], reference: &[WindowRollout]| {
        let positions = |rollouts: &[WindowRollout]| -> Vec<[f64; 2]> {
            rollouts.iter().flat_map(|r| r.positions.clone()).collect()
        };
        let (ours, reference) = (positions(ours), positions(reference));
        assert_eq!(ours.len(), reference.len());
        let pairs = ours.into_iter().zip(reference);
        pairs.map(|(a, b)| (a[0] - b[0]).hypot(a[1] - b[1])).max_by(f64::total_cmp).unwrap() // NaN is the largest
    };
    let difference = apart(&ours, &forecasts(&*exact.into_forecaster()).unwrap());
    assert!(difference < 1e-3, "{difference} m");
    // The learned weights change the forecasts.
    let change = apart(&ours, &before);
    assert!(change > 1e-2, "{change} m");
}
