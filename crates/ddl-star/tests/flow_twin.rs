//! The differentiable flow against `ddl-dynamics`, in f64, also at the goal and next to it; and its
//! derivatives there, which must be numbers.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

use ddl_dynamics::{Attractor, CholeskyMetric, Euler, NaturalGradientFlow, StableEuler, rollout};
use ddl_star::{FlowConstants, StepRule, natural_gradient_step};
use nalgebra::Vector2;
use proptest::prelude::*;
use tch::{Kind, Tensor};

const SIGMA: f64 = 1e-8;
/// Steps of a forecast.
const HORIZON: i64 = 12;

fn twin(p: [f64; 2], goal: [f64; 2], factor: [f64; 3], dt: f64, rule: StepRule) -> [f64; 2] {
    let constants = FlowConstants {
        sigma: SIGMA,
        time_step: dt,
        rule,
    };
    let next = natural_gradient_step(
        &Tensor::from_slice(&p),
        &Tensor::from_slice(&goal),
        &Tensor::from_slice(&factor),
        constants,
    );
    let next: Vec<f64> = Vec::try_from(next).unwrap();
    [next[0], next[1]]
}

fn oracle(p: [f64; 2], goal: [f64; 2], [a, b, c]: [f64; 3], dt: f64, rule: StepRule) -> [f64; 2] {
    let attractor = Attractor::new(Vector2::from(goal)).unwrap();
    let metric = CholeskyMetric::planar(a, b, c, SIGMA).unwrap();
    let flow = NaturalGradientFlow::new(attractor, metric);
    let start = Vector2::from(p);
    let path = match rule {
        StepRule::Euler => rollout(&flow, &Euler, start, dt, 1),
        StepRule::StableEuler => rollout(&flow, &StableEuler, start, dt, 1),
    };
    path.unwrap()[1].into()
}

/// Anywhere in a scene; sometimes the origin, where offsets of 1e-12 m keep all their digits.
fn place() -> impl Strategy<Value = [f64; 2]> {
    prop_oneof![
        4 => prop::array::uniform2(-20.0..20.0),
        1 => Just([0.0, 0.0]),
    ]
}

/// A goal, and a walker anywhere, at the goal, or that close to it in any direction.
fn goal_and_walker() -> impl Strategy<Value = ([f64; 2], [f64; 2])> {
    let distance = prop::sample::select(vec![None, Some(0.0), Some(1e-12), Some(1e-6)]);
    (place(), place(), distance, 0.0..std::f64::consts::TAU).prop_map(
        |(goal, anywhere, distance, direction): (_, _, Option<f64>, f64)| {
            let near = |distance: f64| {
                [
                    goal[0] + distance * direction.cos(),
                    goal[1] + distance * direction.sin(),
                ]
            };
            (goal, distance.map_or(anywhere, near))
        },
    )
}

/// Walkers side by side, each rolled out for 12 steps: the derivatives of a loss over all positions, by
/// the starts `[P, 2]` and the factors `[12, P, 3]`.
fn gradients_of_a_chain(
    walkers: &[([f64; 2], [f64; 2])],
    factors: &[f64],
    rule: StepRule,
    kind: Kind,
) -> [Tensor; 2] {
    let constants = FlowConstants {
        sigma: SIGMA,
        time_step: 0.4,
        rule,
    };
    let count = walkers.len() as i64;
    let leaf = |numbers: &[f64], shape: &[i64]| {
        let tensor = Tensor::from_slice(numbers).reshape(shape);
        tensor.to_kind(kind).set_requires_grad(true)
    };
    let (goals, starts): (Vec<[f64; 2]>, Vec<[f64; 2]>) = walkers.iter().copied().unzip();
    let starts = leaf(starts.as_flattened(), &[count, 2]);
    let factors = leaf(factors, &[HORIZON, count, 3]);
    let goals = Tensor::from_slice(goals.as_flattened())
        .reshape([count, 2])
        .to_kind(kind);
    let mut positions = starts.shallow_clone();
    let mut path = Vec::new();
    for t in 0..HORIZON {
        positions = natural_gradient_step(&positions, &goals, &factors.get(t), constants);
        path.push(positions.shallow_clone());
    }
    // off the goals, so that the loss has a slope there
    let loss = (Tensor::stack(&path, 0) - &goals - 0.5).square().sum(kind);
    loss.backward();
    [starts.grad(), factors.grad()]
}

fn are_numbers(tensor: &Tensor) -> bool {
    tensor.defined() && tensor.isfinite().all().int64_value(&[]) == 1
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1_500))]

    #[test]
    fn the_twin_steps_as_the_crate_does(
        (goal, p) in goal_and_walker(),
        factor in prop::array::uniform3(-3.0..3.0),
        dt in 1e-3..10.0f64,
    ) {
        for rule in [StepRule::Euler, StepRule::StableEuler] {
            let (ours, theirs) = (twin(p, goal, factor, dt, rule), oracle(p, goal, factor, dt, rule));
            let difference = (ours[0] - theirs[0]).hypot(ours[1] - theirs[1]);
            prop_assert!(difference < 1e-6, "{rule:?}: {ours:?} against {theirs:?}");
        }
    }

    #[test]
    fn no_gradient_of_a_step_is_nan(
        (goal, p) in goal_and_walker(),
        factor in prop::array::uniform3(-3.0..3.0),
    ) {
        for rule in [StepRule::Euler, StepRule::StableEuler] {
            let p = Tensor::from_slice(&p).set_requires_grad(true);
            let l = Tensor::from_slice(&factor).set_requires_grad(true);
            let constants = FlowConstants { sigma: SIGMA, time_step: 0.4, rule };
            let next = natural_gradient_step(&p, &Tensor::from_slice(&goal), &l, constants);
            (next - 0.5).square().sum(Kind::Double).backward();
            prop_assert!(are_numbers(&p.grad()) && are_numbers(&l.grad()), "{rule:?}");
        }
    }
}

/// Walkers side by side in a chain, which costs hardly more than one.
const SIDE_BY_SIDE: usize = 16;

proptest! {
    #![proptest_config(ProptestConfig::with_cases(100))]

    /// Stable steps arrive, and then every further step is taken at the goal.
    #[test]
    fn no_gradient_through_twelve_steps_is_nan(
        walkers in prop::collection::vec(goal_and_walker(), SIDE_BY_SIDE),
        factors in prop::collection::vec(-3.0..3.0f64, 3 * HORIZON as usize * SIDE_BY_SIDE),
    ) {
        for rule in [StepRule::Euler, StepRule::StableEuler] {
            for kind in [Kind::Double, Kind::Float] {
                for gradient in gradients_of_a_chain(&walkers, &factors, rule, kind) {
                    prop_assert!(are_numbers(&gradient), "{rule:?}, {kind:?}: {gradient}");
                }
            }
        }
    }
}

/// L = 1.25^(1/2) I walks 0.5 m a step: at the goal after 2 m, and there for the other eight steps.
#[test]
fn gradients_reach_back_from_beyond_the_arrival() {
    let round = 1.25_f64.sqrt();
    let factors: Vec<f64> = [round, 0.0, round].repeat(HORIZON as usize);
    let [start, shape] = gradients_of_a_chain(
        &[([0.0, 0.0], [2.0, 0.0])],
        &factors,
        StepRule::StableEuler,
        Kind::Double,
    );
    assert!(
        are_numbers(&start) && are_numbers(&shape),
        "{start} {shape}"
    );
    // before the arrival a longer factor shortens the way left
    assert!(shape.get(0).abs().max().double_value(&[]) > 1e-3, "{shape}");
}
