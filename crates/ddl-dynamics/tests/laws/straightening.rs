//! Straightening: paths with corners and turns become straight lines, and the flow follows them.

use ddl_dynamics::{
    Chain, CholeskyMetric, DiffeomorphicFlow, Diffeomorphism, DynamicsError, LyapunovCertificate, Real, StableEuler,
    Straightening, rollout,
};
use nalgebra::{ComplexField, SVector, Vector1, Vector2, Vector3};
use proptest::{prelude::*, test_runner::TestCaseResult};

use crate::{for_every_space, map_draw::PolygonDraw};

const LAYERS: usize = 150;

fn curve<const D: usize>(point: impl Fn(f64) -> SVector<f64, D>) -> Vec<SVector<f64, D>> {
    (0..=80).map(|i| point(f64::from(i) / 80.0)).collect()
}

fn polygon<const N: usize>(corners: [[f64; 2]; N]) -> Vec<Vector2<f64>> {
    corners.map(Vector2::from).to_vec()
}

/// Out along a wall, around its end, and back on the other side; the legs are `apart` metres apart.
fn hairpin(apart: f64) -> Vec<Vector2<f64>> {
    polygon([[0.0, 0.0], [3.0, 0.0], [3.0, apart], [0.0, apart]])
}

fn length<const D: usize>(path: &[SVector<f64, D>]) -> f64 {
    path.windows(2).map(|pair| (pair[1] - pair[0]).norm()).sum()
}

fn distance<const D: usize>(point: &SVector<f64, D>, path: &[SVector<f64, D>]) -> f64 {
    let to_side = |pair: &[SVector<f64, D>]| {
        let side = pair[1] - pair[0];
        let share = (point - pair[0]).dot(&side) / side.norm_squared();
        (point - pair[0] - side * share.clamp(0.0, 1.0)).norm()
    };
    path.windows(2).map(to_side).fold(f64::INFINITY, f64::min)
}

/// The path of the flow that goes straight to the goal in the chart, in steps of 1 cm.
struct Descent<const D: usize> {
    positions: Vec<SVector<f64, D>>,
    /// Angle between the first step and the path, and the largest angle between a step and the direction to the goal
    /// (degrees).
    departure: f64,
    widest: f64,
    missed: f64,
}

fn descended<const D: usize>(psi: &Chain<f64, D>, start: SVector<f64, D>, path: &[SVector<f64, D>]) -> Descent<D> {
    let (goal, step) = (path[path.len() - 1], 0.01);
    let identity = CholeskyMetric::identity();
    let flow = DiffeomorphicFlow::in_chart(goal, psi.clone(), identity).unwrap();
    // V falls at the rate 1, so this many steps are enough; the last ones end exactly on the goal.
    let steps = (flow.potential(&start) / step).floor() as usize;
    let positions = rollout(&flow, &StableEuler, start, step, steps).unwrap();
    let certificate = LyapunovCertificate::of_rollout(&flow, &positions, step).unwrap();
    assert_eq!(certificate.verify(), Ok(()));
    let turns = positions
        .windows(2)
        .map(|pair| (pair[1] - pair[0]).angle(&(goal - pair[0])));
    Descent {
        departure: (positions[1] - start).angle(&(path[1] - path[0])).to_degrees(),
        widest: turns.fold(0.0, f64::max).to_degrees(),
        missed: (positions[steps] - goal).norm(),
        positions,
    }
}

/// Checks a path: it is straightened to a mean residual below 0.3 % of its length and a largest one below 1.5 %. The
/// flow starts along the path and follows it to the goal within 1 % of its length.
fn straightened_and_walked<const D: usize>(path: &[SVector<f64, D>]) -> Descent<D> {
    let Straightening {
        chain,
        mean_residual,
        largest_residual,
        samples,
        targets,
        ..
    } = Chain::straightening(path, LAYERS).unwrap();
    let whole = length(path);
    let way = descended(&chain, path[0], path);
    let astray = way.positions.iter().map(|p| distance(p, path));
    let astray = astray.fold(0.0, f64::max);
    assert!(chain.layers().len() <= LAYERS);
    assert!(mean_residual < 0.003 * whole, "{mean_residual}");
    assert!(largest_residual < 0.015 * whole, "{largest_residual}");
    // The targets are a straight line, as long as the path minus the corners cut by the samples.
    let line = targets[63] - targets[0];
    assert!((line.norm() / whole - 1.0).abs() < 0.03);
    for (sample, target) in samples.iter().zip(&targets) {
        assert!(distance(target, &[targets[0], targets[63]]) < 1e-9 * whole);
        assert!(distance(sample, path) < 1e-9 * whole);
        assert!((chain.apply(sample) - target).norm() <= largest_residual);
    }
    assert!(astray < 0.01 * whole, "{astray}");
    assert!(way.departure < 10.0, "{}", way.departure);
    assert!(way.missed < 0.02, "{}", way.missed);
    way
}

#[test]
fn corner_hairpin_curves_and_arc_become_straight_and_are_walked() {
    use std::f64::consts::{PI, TAU};
    straightened_and_walked(&polygon([[0.0, 0.0], [4.0, 0.0], [4.0, 4.0]]));
    straightened_and_walked(&hairpin(0.4));
    straightened_and_walked(&curve(|t| Vector2::new(6.0 * t, 1.5 * (TAU * t).sin())));
    // An S that swings out further than it advances, and three quarters of a turn of a helix.
    straightened_and_walked(&curve(|t| Vector2::new(3.0 * (TAU * t).sin(), 4.0 * t)));
    straightened_and_walked(&curve(|t| {
        let (sin, cos) = (1.5 * PI * t).sin_cos();
        Vector3::new(2.0 * cos, 2.0 * sin, 1.5 * t)
    }));
}

/// The goal is 1 m away behind a wall, and the path first leads away from it for metres. A positive-definite matrix
/// alone never turns a velocity by more than 90 degrees. The goal is also reached from beside the path.
#[test]
fn around_the_end_of_a_wall_and_back() {
    let path = hairpin(1.0);
    let way = straightened_and_walked(&path);
    assert!(way.widest > 120.0, "{}", way.widest);
    // Never through the wall, which is at y = 0.5 from far left to x = 2.8.
    for pair in way.positions.windows(2) {
        assert!((pair[0].y < 0.5) == (pair[1].y < 0.5) || pair[1].x > 2.8, "{}", pair[1]);
    }
    let chain = Chain::straightening(&path, LAYERS).unwrap().chain;
    for start in [[0.0, -0.4], [1.5, 0.2], [3.6, 0.5], [-1.0, 0.0], [1.0, 2.0]] {
        let missed = descended(&chain, Vector2::from(start), &path).missed;
        assert!(missed < 0.03, "{missed}");
    }
}

#[test]
fn the_same_path_gives_the_same_chain_in_any_unit_and_place() {
    let path = hairpin(1.0);
    let first = Chain::straightening(&path, 60).unwrap();
    assert_eq!(first, Chain::straightening(&path, 60).unwrap());
    let elsewhere: Vec<_> = path.iter().map(|p| p * 1024.0 + Vector2::new(-4096.0, 512.0)).collect();
    let second = Chain::straightening(&elsewhere, 60).unwrap();
    assert!((second.mean_residual / first.mean_residual / 1024.0 - 1.0).abs() < 1e-6);
}

#[test]
fn a_straight_path_needs_no_layer() {
    let path = [0.0, 1.0, 5.0, 5.0].map(|x| Vector3::new(x, -2.0 * x, 0.5));
    let straightening = Chain::straightening(&path, LAYERS).unwrap();
    assert_eq!(straightening.chain.layers(), []);
    assert!(straightening.largest_residual < 1e-14);
    let line = [1.0_f32, 0.5, -3.0].map(Vector1::new);
    assert_eq!(Chain::straightening(&line, 10).unwrap().chain.layers(), []);
}

#[test]
fn invalid_paths_are_refused() {
    let refused = |path: &[[f64; 2]]| {
        let path: Vec<_> = path.iter().copied().map(Vector2::from).collect();
        Chain::straightening(&path, 10).unwrap_err()
    };
    let length = |points, length| DynamicsError::InvalidPathLength { points, length };
    assert_eq!(refused(&[]), length(0, 0.0));
    assert_eq!(refused(&[[1.0, 2.0]]), length(1, 0.0));
    assert_eq!(refused(&[[1.0, 2.0]; 3]), length(3, 0.0));
    assert_eq!(refused(&[[-f64::MAX, 0.0], [f64::MAX, 0.0]]), length(2, f64::INFINITY));
    assert_eq!(refused(&[[0.0, 0.0], [5e-324, 0.0]]), length(2, 5e-324));
    // 16 times the distance of the start overflows `f64`, but the path itself does not.
    let far = refused(&[[2e307, 0.0], [2e307, 1e300]]);
    assert_eq!(far, length(2, 1e300));
    let infinite = refused(&[[0.0, 0.0], [0.0, f64::INFINITY]]).to_string();
    assert!(
        infinite.starts_with("component 1 of point 1 of the path is inf"),
        "{infinite}"
    );
    let DynamicsError::PathTurnsBack { along } = refused(&[[0.0, 0.0], [0.0, 2.0], [0.0, 1.0], [3.0, 1.0]]) else {
        panic!("not the expected error")
    };
    assert!((along - 2.0).abs() < 0.1, "{along}");
}

fn no_polygon_breaks_it<T: Real, const D: usize>(draw: &PolygonDraw) -> TestCaseResult {
    match Chain::straightening(&draw.points::<T, D>(), 3) {
        Ok(straightening) => {
            prop_assert!(straightening.largest_residual.is_finite());
            prop_assert!(straightening.mean_residual <= straightening.largest_residual);
            for point in straightening.samples.iter().chain(&straightening.targets) {
                prop_assert!(point.iter().all(ComplexField::is_finite));
                prop_assert!(straightening.chain.apply(point).iter().all(ComplexField::is_finite));
            }
        }
        Err(DynamicsError::InvalidPathLength { .. } | DynamicsError::PathTurnsBack { .. }) => {}
        Err(error) => prop_assert!(false, "{error}"),
    }
    Ok(())
}
for_every_space!(no_polygon_breaks_it, any_polygon);
