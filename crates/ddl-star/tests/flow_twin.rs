//! The differentiable flow against `ddl-dynamics`, in f64, also at the goal and next to it.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

use ddl_dynamics::{Attractor, CholeskyMetric, Euler, NaturalGradientFlow, StableEuler, rollout};
use ddl_star::{FlowConstants, Integrator, natural_gradient_step};
use nalgebra::Vector2;
use proptest::prelude::*;
use tch::Tensor;

const SIGMA: f64 = 1e-8;

fn twin(
    p: [f64; 2],
    goal: [f64; 2],
    factor: [f64; 3],
    dt: f64,
    integrator: Integrator,
) -> [f64; 2] {
    let constants = FlowConstants {
        sigma: SIGMA,
        time_step: dt,
        integrator,
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

fn oracle(p: [f64; 2], goal: [f64; 2], [a, b, c]: [f64; 3], dt: f64, stable: bool) -> [f64; 2] {
    let attractor = Attractor::new(Vector2::from(goal)).unwrap();
    let metric = CholeskyMetric::planar(a, b, c, SIGMA).unwrap();
    let flow = NaturalGradientFlow::new(attractor, metric);
    let start = Vector2::from(p);
    let path = if stable {
        rollout(&flow, &StableEuler, start, dt, 1)
    } else {
        rollout(&flow, &Euler, start, dt, 1)
    };
    path.unwrap()[1].into()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    #[test]
    fn the_twin_steps_as_the_crate_does(
        p in prop::array::uniform2(-20.0..20.0),
        goal in prop::array::uniform2(-20.0..20.0),
        factor in prop::array::uniform3(-3.0..3.0),
        dt in 1e-3..10.0f64,
        offset in prop::sample::select(vec![None, Some(0.0), Some(1e-12), Some(1e-6)]),
    ) {
        // None: anywhere; otherwise the walker stands that close to the goal
        let p = offset.map_or(p, |offset: f64| [goal[0] + offset, goal[1]]);
        for (integrator, stable) in [(Integrator::Euler, false), (Integrator::StableEuler, true)] {
            let (ours, theirs) =
                (twin(p, goal, factor, dt, integrator), oracle(p, goal, factor, dt, stable));
            let difference = (ours[0] - theirs[0]).hypot(ours[1] - theirs[1]);
            prop_assert!(difference < 1e-6, "{integrator:?}: {ours:?} against {theirs:?}");
        }
    }

    #[test]
    fn no_gradient_is_nan_at_the_goal(
        goal in prop::array::uniform2(-20.0..20.0),
        factor in prop::array::uniform3(-3.0..3.0),
        offset in prop::sample::select(vec![0.0, 1e-12, 1e-3]),
    ) {
        for integrator in [Integrator::Euler, Integrator::StableEuler] {
            let p = Tensor::from_slice(&[goal[0] + offset, goal[1]]).set_requires_grad(true);
            let l = Tensor::from_slice(&factor).set_requires_grad(true);
            let constants = FlowConstants { sigma: SIGMA, time_step: 0.4, integrator };
            let next = natural_gradient_step(&p, &Tensor::from_slice(&goal), &l, constants);
            next.square().sum(tch::Kind::Double).backward();
            for tensor in [&p, &l] {
                prop_assert_eq!(tensor.grad().isfinite().all().int64_value(&[]), 1);
            }
        }
    }
}
