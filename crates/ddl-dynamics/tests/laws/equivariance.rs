//! The flows know no preferred place and no preferred direction.

use ddl_dynamics::{Attractor, MetricSchedule, NaturalGradientFlow, Real, StableEuler, rollout};
use nalgebra::{SMatrix, SVector};
use proptest::{prelude::*, test_runner::TestCaseResult};

use crate::{
    draw::{METRICS, SceneDraw},
    for_every_space,
};

/// A rotation: two reflections, one after the other.
fn rotation<T: Real, const D: usize>(scene: &SceneDraw) -> Option<SMatrix<T, D, D>> {
    let reflection = |unit: SVector<T, D>| {
        SMatrix::<T, D, D>::identity() - unit * unit.transpose() * T::rounded(2.0)
    };
    let first = scene.unit::<T, D>()?;
    let second = scene.start::<T, D>().try_normalize(T::rounded(1e-6))?;
    Some(reflection(first) * reflection(second))
}

/// Start and goal moved and turned, and the metrics with them, give the path moved and turned.
fn a_moved_scene_has_the_moved_path<T: Real, const D: usize>(scene: &SceneDraw) -> TestCaseResult {
    let Some(turn) = rotation::<T, D>(scene) else {
        return Ok(());
    };
    let shift = scene.direction::<T, D>() * T::rounded(100.0);
    let moved = |position: SVector<T, D>| turn * position + shift;
    let (attractor, start) = (scene.attractor::<T, D>(), scene.start());
    let metrics = scene.metrics::<T, D>();
    let turned = metrics
        .iter()
        .map(|p| p.congruent(&turn).unwrap())
        .collect();
    let walk = |attractor, metrics, start| {
        let flow = NaturalGradientFlow::new(attractor, MetricSchedule::new(metrics).unwrap());
        rollout(&flow, &StableEuler, start, scene.dt(), METRICS).unwrap()
    };
    let path = walk(attractor, metrics.clone(), start);
    let image = Attractor::new(moved(*attractor.goal())).unwrap();
    let moved_path = walk(image, turned, moved(start));
    // A step to the closest point keeps the direction of what is left only as well as its length.
    let scale = start.norm() + attractor.goal().norm() + shift.norm();
    let mut tolerance = T::rounded(64.0) * T::EPSILON * scale;
    for (step, (position, other)) in path.iter().zip(&moved_path).enumerate() {
        prop_assert!(
            (moved(*position) - other).norm() <= tolerance,
            "step {step}: {} off, {tolerance} allowed",
            (moved(*position) - other).norm()
        );
        // The step map magnifies a difference by the condition number at the most, here below 60.
        tolerance *= T::rounded(4.0);
    }
    Ok(())
}
for_every_space!(a_moved_scene_has_the_moved_path, well_conditioned_scene);
