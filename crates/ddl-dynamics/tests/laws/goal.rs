//! At the goal, and a hair's breadth from it.

use ddl_dynamics::{
    Attractor, Euler, Flow, Integrator, LyapunovCertificate, Real, StableEuler, State, StepLimit,
    rollout,
};
use nalgebra::{SVector, Vector2};
use proptest::{prelude::*, test_runner::TestCaseResult};

use crate::{
    draw::{METRICS, SceneDraw},
    for_every_space,
};

/// Nothing moves at the goal, nothing is NaN there, and a certificate holds.
fn at_the_goal_nothing_moves<T: Real, const D: usize>(scene: &SceneDraw) -> TestCaseResult {
    let attractor = scene.attractor::<T, D>();
    let goal = *attractor.goal();
    let metrics = scene.metrics::<T, D>();
    let flow = scene.flow();
    prop_assert_eq!(
        flow.velocity(&State::at(goal)).unwrap(),
        SVector::<T, D>::zeros()
    );
    prop_assert_eq!(
        Euler.step(&flow, &State::at(goal), scene.dt()).unwrap(),
        goal
    );
    let path = rollout(&flow, &StableEuler, goal, scene.dt(), METRICS).unwrap();
    prop_assert!(path.iter().all(|position| *position == goal));
    let certificate = LyapunovCertificate::new(&path, &metrics, &attractor, scene.dt()).unwrap();
    prop_assert_eq!(certificate.holds(), Ok(()));
    for step in certificate.steps() {
        prop_assert!(step.rate.is_zero() && step.angle.is_zero() && step.step_margin.is_none());
    }
    Ok(())
}
for_every_space!(at_the_goal_nothing_moves, any_scene);

#[test]
fn one_spacing_from_a_far_goal_the_walker_arrives() {
    // In f32 at 1 km the nearest other position is 6e-5 m away: there is nothing in between.
    let goal = Vector2::new(1000.0_f32, 0.0);
    let attractor = Attractor::new(goal).unwrap();
    let start = Vector2::new(1000.0_f32.next_down(), 0.0);
    let slow = Vector2::new(1e-8_f32, 0.0);
    let step = StableEuler::advance(&attractor, &start, &slow, 0.4).unwrap();
    assert_eq!((step.position, step.limit), (goal, StepLimit::Resolution));
}
