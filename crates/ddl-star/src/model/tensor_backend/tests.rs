//! Kernels and tape against libtorch.
#![allow(clippy::unwrap_used, reason = "a test may panic")]

use super::*;
use crate::device::ComputeDevice;
use crate::model::{NoiseInput, TorchNetwork};
use ddl_core::{WINDOW, Window};
use ddl_data::{Dataset, WindowRule};
use ddl_network::{
    BackboneKind, DeviceChoice, ForecastWindows, MotionNetwork, Noise, StarConfig, StepRule, Variant, WindowRollout,
};
use tch::Kind;

/// Windows with very different numbers of pedestrians, including one with a single pedestrian; or only the latter.
fn scenes() -> [Vec<Window>; 3] {
    let windows = Dataset::simulated(1).recordings()[0].windows(WindowRule::Complete);
    let alone = Window::new("alone", 0, 10, windows[0].pedestrians()[..1].to_vec(), vec![windows[0].track(0).to_vec()])
        .unwrap();
    let some: Vec<Window> = windows.into_iter().step_by(9).take(4).collect();
    let many = some.iter().chain([&alone]).cloned().collect();
    [some, many, vec![alone]]
}

fn batch(windows: &[Window], kind: Kind) -> WindowBatch {
    let windows: Vec<&Window> = windows.iter().collect();
    WindowBatch::new(&windows, WINDOW, WINDOW - 1, 2.0, tch::Device::Cpu, kind).unwrap()
}

fn configs() -> Vec<StarConfig> {
    let goal_frame = [Variant::NoDynamics, Variant::Full].map(StarConfig::recommended);
    let world = Variant::ALL.map(StarConfig::published);
    let with = |config: StarConfig| {
        BackboneKind::ALL.map(|backbone| StarConfig { backbone, feed_forward_width: 96, ..config.clone() })
    };
    world.into_iter().chain(goal_frame).flat_map(with).collect()
}

fn name(config: &StarConfig) -> String {
    format!("{} {} {:?}", config.backbone, config.variant, config.frame)
}

fn network(config: &StarConfig, kind: Kind) -> TorchNetwork {
    crate::set_threads(1);
    let cpu = ComputeDevice::open(DeviceChoice::Cpu).unwrap();
    TorchNetwork::with_precision(config.clone(), 3, cpu, kind).unwrap()
}

/// A loss and its gradient: by kernels and tape in single precision, by libtorch only in double precision.
fn gradient(
    config: &StarConfig,
    kind: Kind,
    loss: impl FnOnce(&TorchNetwork, TensorEngine<'_>) -> Tensor,
) -> (f64, Tensor) {
    let network = network(config, kind);
    let parameters = network.parameters();
    let kernels = network.kernels().unwrap();
    assert_eq!(kernels.is_some(), kind == Kind::Float, "{kind:?}");
    let (loss, gradient) = if let Some(kernels) = kernels {
        let pass = KernelPass::new(&kernels, Mode::Evaluate, 0, network.copy_noise_weight());
        let loss = loss(&network, TensorEngine::Kernels(&pass));
        let gradient = pass.gradient(&loss, &network.layers, parameters.layout().count());
        (loss, Tensor::from_slice(&gradient.unwrap()))
    } else {
        let torch = TorchBackend::training(parameters, Mode::Evaluate);
        let loss = loss(&network, TensorEngine::Torch(&torch));
        let gradient = torch.gradient(&loss, parameters).unwrap();
        (loss, gradient)
    };
    (loss.double_value(&[]), gradient.to_kind(Kind::Double))
}

/// The mean square of single steps from true positions.
fn teacher_forced(windows: &[Window], network: &TorchNetwork, pass: TensorEngine<'_>) -> Tensor {
    let kind = network.kind;
    let batch = batch(windows, kind);
    let ones = Tensor::ones([1, 16], (kind, tch::Device::Cpu));
    let noise = NoiseInput::Draws(ones * 0.3);
    let goals = batch.positions.get(WINDOW as i64 - 1);
    let forecast = network.layers.teacher_forced(&batch, &goals, &noise, pass);
    let truth = batch.positions.narrow(0, 1, WINDOW as i64 - 1);
    (forecast - truth).square().mean(None::<Kind>)
}

fn walk(windows: &[Window], network: &TorchNetwork, pass: TensorEngine<'_>) -> Tensor {
    let batch = batch(windows, network.kind);
    let goals = batch.positions.narrow(0, WINDOW as i64 - 1, 1) + 0.3;
    let noise = NoiseInput::Expected;
    let walk = network.layers.roll_out(&batch, &goals, &noise, StepRule::Bounded, pass);
    let truth = batch.positions.narrow(0, 8, 12);
    crate::training::mean_distance(&walk.positions.squeeze_dim(1), &truth)
}

/// A loss, with the largest relative errors of it and of its gradient.
type Compared = (fn(&[Window], &TorchNetwork, TensorEngine<'_>) -> Tensor, [f64; 2]);

#[test]
fn kernels_and_tape_give_the_gradients_of_libtorch() {
    let [some, many, alone] = scenes();
    let steps: Compared = (teacher_forced, [1e-5, 1e-4]);
    let walks: Compared = (walk, [1e-4, 5e-3]);
    for config in configs() {
        for (windows, (loss, [of_loss, of_gradient])) in
            [(&some, steps), (&many, steps), (&alone, steps), (&some, walks), (&many, walks)]
        {
            let computed = |kind| gradient(&config, kind, |network, pass| loss(windows, network, pass));
            let (torch_loss, torch_gradient) = computed(Kind::Double);
            let (size, name) = (torch_gradient.norm().double_value(&[]), name(&config));
            assert!(size > 1e-3, "{name}: {size}");
            let (loss, ours) = computed(Kind::Float);
            let off = (loss / torch_loss - 1.0).abs();
            assert!(off < of_loss, "{name}: {loss} {torch_loss}");
            let off = (ours - &torch_gradient).norm().double_value(&[]);
            assert!(off < of_gradient * size, "{name}: {off} of {size}");
        }
    }
}

/// The input of a forecast: windows, goals, noise, step rule, shares.
type RolloutQuestion = (Vec<Window>, Vec<Vec<Vec<[f64; 2]>>>, Noise, StepRule, Option<Vec<Vec<f64>>>);

/// Several goals or several noise vectors, with the whole metric or shares of it.
fn questions(rule: StepRule) -> Vec<RolloutQuestion> {
    // Close to the goal, rounding decides the direction of a plain step, so goals for plain steps are far away.
    let beyond = if rule == StepRule::Euler { 20.0 } else { 0.0 };
    let [_, many, alone] = scenes();
    let mut questions = Vec::new();
    // In map coordinates f32 resolves half a metre, so positions must first be made relative to the scene.
    let on_a_map = |window: &Window| window.map_positions(|_, _, [x, y]| [x + 691_608.0, y + 5_334_763.0]);
    for windows in [many.iter().map(on_a_map).collect(), alone] {
        let draws = Noise::Draws { count: 3, seed: 5 };
        for (count, noise) in [(3_u8, Noise::Expected), (1, draws)] {
            let goals = |window: &Window, i: usize| {
                let [x, y] = window.track(i)[WINDOW - 1];
                let wave = |k: u8| (f64::from(k) + i as f64).sin();
                (0..count).map(|k| [x + beyond + wave(2 * k), y - wave(2 * k + 1)]).collect()
            };
            let of_window =
                |window: &Window| -> Vec<Vec<[f64; 2]>> { (0..window.len()).map(|i| goals(window, i)).collect() };
            let goals: Vec<_> = windows.iter().map(of_window).collect();
            let of_window = |window: &Window| -> Vec<f64> { (0..window.len()).map(|i| (i % 4) as f64 / 3.0).collect() };
            let shares: Vec<_> = windows.iter().map(of_window).collect();
            for shares in [None, Some(shares)] {
                questions.push((windows.clone(), goals.clone(), noise, rule, shares));
            }
        }
    }
    questions
}

fn answers(network: &dyn ForecastWindows, questions: &[RolloutQuestion]) -> Vec<WindowRollout> {
    let answer = |(windows, goals, noise, rule, shares): &RolloutQuestion| {
        let shares = shares.as_deref();
        network.forecast_windows(windows, goals, *noise, *rule, shares)
    };
    questions.iter().flat_map(|q| answer(q).unwrap()).collect()
}

/// Largest difference of positions (m) and factors.
fn apart(ours: &[WindowRollout], reference: &[WindowRollout]) -> f64 {
    assert_eq!(ours.len(), reference.len());
    let numbers = |rollout: &WindowRollout| -> Vec<f64> {
        let factors = rollout.factors.iter().flatten().flatten();
        rollout.positions.as_flattened().iter().chain(factors).copied().collect()
    };
    let pairs = ours.iter().zip(reference).flat_map(|(ours, reference)| {
        let (ours, reference) = (numbers(ours), numbers(reference));
        assert_eq!(ours.len(), reference.len());
        ours.into_iter().zip(reference)
    });
    let differences = pairs.map(|(ours, reference)| (ours - reference).abs());
    // `total_cmp` orders NaN as the largest value.
    differences.max_by(f64::total_cmp).unwrap()
}

/// Positions and factors of forecasts by the kernels equal those of libtorch in double precision, before and after the
/// weights change.
#[test]
fn kernels_give_the_forecasts_of_libtorch() {
    let [bounded, euler] = [StepRule::Bounded, StepRule::Euler].map(questions);
    for config in configs() {
        let name = name(&config);
        let agree = |plain: &MotionNetwork, torch: TorchNetwork, questions: &[&[RolloutQuestion]]| {
            let weights = torch.parameters().to_weights().unwrap();
            assert_eq!(plain.copy_weights().unwrap(), weights, "{name}");
            let torch = torch.into_forecaster();
            for questions in questions {
                let ours = answers(plain, questions);
                assert!(ours.iter().all(|rollout| rollout.hypotheses == 3));
                let difference = apart(&ours, &answers(&*torch, questions));
                assert!(difference < 1e-4, "{name}: {difference}");
            }
        };
        let plain = MotionNetwork::new(config.clone(), 3).unwrap();
        agree(&plain, network(&config, Kind::Double), &[&bounded, &euler]);

        let before = answers(&plain, &bounded);
        let torch = network(&config, Kind::Double);
        let mut flat = torch.parameters().flat.shallow_clone();
        flat *= 1.3;
        let weights = torch.parameters().to_weights().unwrap();
        let plain = MotionNetwork::reading(config.clone(), |_| Ok(weights)).unwrap();
        agree(&plain, torch, &[&bounded]);
        let change = apart(&answers(&plain, &bounded), &before);
        assert!(change > 2e-2, "{name}: {change}");
    }
}
