//! Compares the differentiable flow with `ddl-dynamics` in f64, also at the goal and close to it, and checks that its
//! derivatives there are finite.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

use super::*;
use ddl_dynamics::{Attractor, CholeskyMetric, Euler, NaturalGradientFlow, StableEuler, rollout};
use nalgebra::Vector2;
use proptest::prelude::*;
use tch::Kind;

const SIGMA: f64 = 1e-8;
const HORIZON: i64 = 12;

/// Bounds of the steps of one pedestrian, and whether they are absolute.
type Bounds = (MotionBounds<f64>, bool);

/// A plain Euler step of `dt` seconds, or a step within bounds with the given remaining time.
#[derive(Debug, Clone, Copy)]
enum FlowStep {
    Euler { dt: f64 },
    Bounded(Bounds, StepTime<f64>),
}

fn tensor_step(p: &Tensor, goal: &Tensor, factor: &Tensor, step: FlowStep) -> Tensor {
    let constants = |time_step: f64| FlowConstants { sigma: SIGMA, time_step };
    match step {
        FlowStep::Euler { dt } => natural_gradient_step(p, goal, factor, constants(dt)),
        FlowStep::Bounded((bounds, absolute), time) => {
            let like = |numbers: &[f64]| Tensor::from_slice(numbers).to_kind(p.kind());
            let bounds = StepBounds {
                top_speed: like(&[bounds.top_speed()]),
                velocity: like(bounds.velocity().as_slice()),
                share: like(&[bounds.share()]),
                absolute,
            };
            bounded_step(p, goal, factor, constants(time.dt), &bounds, time)
        }
    }
}

fn twin(p: [f64; 2], goal: [f64; 2], factor: [f64; 3], step: FlowStep) -> [f64; 2] {
    let [p, goal] = [p, goal].map(|place| Tensor::from_slice(&place));
    let next = tensor_step(&p, &goal, &Tensor::from_slice(&factor), step);
    let next: Vec<f64> = Vec::try_from(next).unwrap();
    [next[0], next[1]]
}

fn oracle(p: [f64; 2], goal: [f64; 2], [a, b, c]: [f64; 3], step: FlowStep) -> [f64; 2] {
    let attractor = Attractor::new(Vector2::from(goal)).unwrap();
    let metric = CholeskyMetric::planar(a, b, c, SIGMA).unwrap();
    let start = Vector2::from(p);
    let path = match step {
        FlowStep::Euler { dt } => {
            let flow = NaturalGradientFlow::new(attractor, metric);
            rollout(&flow, &Euler, start, dt, 1)
        }
        FlowStep::Bounded((bounds, absolute), time) => {
            let bounds = if absolute { bounds.absolute() } else { bounds };
            let metric = bounds.shape(&metric, &(attractor.goal() - start), time);
            let flow = NaturalGradientFlow::new(attractor, metric);
            rollout(&flow, &StableEuler, start, time.dt, 1)
        }
    };
    path.unwrap()[1].into()
}

/// Random bounds of a pedestrian, and a step of its twelve.
fn bounds(dt: f64) -> impl Strategy<Value = (Bounds, StepTime<f64>)> {
    let velocity = prop::array::uniform2(-4.0..4.0);
    let draw = (0.5..8.0, velocity, 0.0..=1.0, any::<bool>(), 0..12_usize);
    draw.prop_map(move |(top_speed, velocity, share, absolute, done)| {
        let bounds = MotionBounds::new(top_speed, velocity.into(), share).unwrap();
        let left = 12 - done;
        ((bounds, absolute), StepTime { done, left, dt })
    })
}

/// A random position in a scene; sometimes the origin, where offsets of 1e-12 m keep all their digits.
fn place() -> impl Strategy<Value = [f64; 2]> {
    prop_oneof![
        4 => prop::array::uniform2(-20.0..20.0),
        1 => Just([0.0, 0.0]),
    ]
}

/// A goal, and a pedestrian anywhere, at the goal, or very close to it in any direction.
fn goal_and_pedestrian() -> impl Strategy<Value = ([f64; 2], [f64; 2])> {
    let distance = prop::sample::select(vec![None, Some(0.0), Some(1e-12), Some(1e-6)]);
    (place(), place(), distance, 0.0..std::f64::consts::TAU).prop_map(
        |(goal, anywhere, distance, direction): (_, _, Option<f64>, f64)| {
            let near = |distance: f64| [goal[0] + distance * direction.cos(), goal[1] + distance * direction.sin()];
            (goal, distance.map_or(anywhere, near))
        },
    )
}

/// The gradients of a loss over all positions by the starts `[P, 2]` and the factors `[12, P, 3]`, for pedestrians that
/// are rolled out side by side for 12 steps.
fn gradients_of_a_chain(
    pedestrians: &[([f64; 2], [f64; 2])],
    factors: &[f64],
    bounds: Option<Bounds>,
    kind: Kind,
) -> [Tensor; 2] {
    let count = pedestrians.len() as i64;
    let leaf = |numbers: &[f64], shape: &[i64]| {
        Tensor::from_slice(numbers).reshape(shape).to_kind(kind).set_requires_grad(true)
    };
    let (goals, starts): (Vec<[f64; 2]>, Vec<[f64; 2]>) = pedestrians.iter().copied().unzip();
    let starts = leaf(starts.as_flattened(), &[count, 2]);
    let factors = leaf(factors, &[HORIZON, count, 3]);
    let goals = Tensor::from_slice(goals.as_flattened()).reshape([count, 2]).to_kind(kind);
    let mut positions = starts.shallow_clone();
    let mut path = Vec::new();
    for t in 0..HORIZON {
        let (done, left, dt) = (t as usize, (HORIZON - t) as usize, 0.4);
        let step = match bounds {
            None => FlowStep::Euler { dt },
            Some(bounds) => FlowStep::Bounded(bounds, StepTime { done, left, dt }),
        };
        positions = tensor_step(&positions, &goals, &factors.get(t), step);
        path.push(positions.shallow_clone());
    }
    // The offset gives the loss a gradient at the goals.
    (Tensor::stack(&path, 0) - &goals - 0.5).square().sum(kind).backward();
    [starts.grad(), factors.grad()]
}

fn are_numbers(tensor: &Tensor) -> bool {
    tensor.defined() && tensor.isfinite().all().int64_value(&[]) == 1
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1_500))]

    #[test]
    fn the_twin_makes_the_same_steps(
        (goal, p) in goal_and_pedestrian(),
        factor in prop::array::uniform3(-3.0..3.0),
        dt in 1e-3..10.0f64,
        (bounds, time) in bounds(0.4),
    ) {
        for step in [FlowStep::Euler { dt }, FlowStep::Bounded(bounds, time)] {
            let (ours, theirs) = (twin(p, goal, factor, step), oracle(p, goal, factor, step));
            let difference = (ours[0] - theirs[0]).hypot(ours[1] - theirs[1]);
            prop_assert!(difference < 1e-6, "{step:?}: {ours:?} against {theirs:?}");
        }
    }
}

const SIDE_BY_SIDE: usize = 16;

proptest! {
    #![proptest_config(ProptestConfig::with_cases(100))]

    /// Stable steps arrive, and every further step starts at the goal.
    #[test]
    fn no_gradient_through_twelve_steps_is_nan(
        pedestrians in prop::collection::vec(goal_and_pedestrian(), SIDE_BY_SIDE),
        factors in prop::collection::vec(-3.0..3.0f64, 3 * HORIZON as usize * SIDE_BY_SIDE),
        (bounds, _) in bounds(0.4),
    ) {
        for bounds in [None, Some(bounds)] {
            for kind in [Kind::Double, Kind::Float] {
                for gradient in gradients_of_a_chain(&pedestrians, &factors, bounds, kind) {
                    prop_assert!(are_numbers(&gradient), "{bounds:?}, {kind:?}: {gradient}");
                }
            }
        }
    }
}

/// Checks that a metric within the bounds has a gradient: a longer factor at the first step changes the path, also
/// through the later steps.
#[test]
fn gradients_reach_back_to_the_first_step() {
    let factors: Vec<f64> = [1.1, 0.2, 0.9].repeat(HORIZON as usize);
    let bounds = MotionBounds::new(2.15, Vector2::new(1.0, 0.0), 1.0).unwrap();
    let pedestrian = ([0.0, 0.0], [4.8, 0.0]);
    let [start, shape] = gradients_of_a_chain(&[pedestrian], &factors, Some((bounds, false)), Kind::Double);
    assert!(are_numbers(&start) && are_numbers(&shape), "{start} {shape}");
    assert!(shape.get(0).abs().max().double_value(&[]) > 1e-3, "{shape}");
    // The last step ends at the goal for any output of the network.
    assert!(shape.get(HORIZON - 1).abs().max().double_value(&[]) < 1e-12, "{shape}");
}
