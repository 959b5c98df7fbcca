//! The picture of plain and stable Euler steps.

#[path = "../../examples/circling/picture.rs"]
mod picture;

use super::{PIXEL, assert_committed, lines};
use ddl_dynamics::{Euler, Flow as _, Integrator as _, StableEuler, State};
use nalgebra::{Matrix2, Vector2};
use picture::{DISTANCES, NEAR, STEPS, TIME_STEP, WHOLE, draw};

/// The path worked out again with `P` multiplied out by hand: L = [1.1 0; 0.4 1.1].
fn expected(is_stable: bool) -> Vec<Vector2<f64>> {
    let metric = Matrix2::new(1.21, 0.44, 0.44, 1.37) + Matrix2::identity() * 1e-8;
    let goal = Vector2::new(4.0, 0.0);
    let mut path = vec![Vector2::zeros()];
    for step in 0..STEPS {
        let offset: Vector2<f64> = path[step] - goal;
        let velocity = -(metric * offset.normalize());
        // where the line of motion is closest to the goal
        let closest = -offset.dot(&velocity) / velocity.norm_squared();
        let limited = is_stable && closest < TIME_STEP;
        let next = path[step] + velocity * if limited { closest } else { TIME_STEP };
        if limited && (next - goal).norm() <= 8.0 * f64::EPSILON * 4.0 {
            path.resize(STEPS + 1, goal);
            return path;
        }
        path.push(next);
    }
    path
}

#[test]
fn the_committed_picture_shows_what_the_rollouts_do() {
    let svg = draw().unwrap();
    assert_committed("stability.svg", "circling", &svg);
    let goal = Vector2::new(4.0, 0.0);
    for (name, is_stable) in [("euler", false), ("stable", true)] {
        let path = expected(is_stable);
        // in metres at 82 and 279 pixels a metre from the upper left corner
        for (plot, corner, scale) in [("whole", WHOLE, 82.0), ("near", NEAR, 279.0)] {
            let [[left, top], _] = corner.frame;
            let drawn = &lines(&svg, &format!("{plot}-{name}"))[0];
            assert_eq!(drawn.len(), STEPS + 1);
            for ([x, y], position) in drawn.iter().zip(&path) {
                let found = Vector2::new(
                    corner.x[0] + (x - left) / scale,
                    corner.y[1] - (y - top) / scale,
                );
                let off = (found - position).amax() * scale;
                assert!(off < PIXEL, "{plot}, {name}: {found} for {position}");
            }
        }
        // from the upper edge, 10 m, to the lower one in 18.5 decades
        let [[_, top], [_, bottom]] = DISTANCES.frame;
        let drawn = &lines(&svg, &format!("distance-{name}"))[0];
        for ([_, y], position) in drawn.iter().zip(&path) {
            let (distance, decades) = ((position - goal).norm(), (y - top) / (bottom - top) * 18.5);
            if distance > 1e-12 {
                assert!(
                    (10_f64.powf(1.0 - decades) / distance - 1.0).abs() < 1e-3,
                    "{distance} m"
                );
            } else {
                // all rounding, but above 0; or 0, below all decades
                let row = if distance > 0.0 {
                    12.5..17.0
                } else {
                    17.5..18.5
                };
                assert!(row.contains(&decades), "{decades}");
            }
        }
    }
    let distances: Vec<_> = expected(false).iter().map(|p| (p - goal).norm()).collect();
    let step = (0..STEPS)
        .find(|&step| distances[step + 1] >= distances[step])
        .unwrap();
    let arrived = expected(true).iter().position(|p| *p == goal).unwrap();
    for note in [
        format!(">step {step} is the first<"),
        format!(">{:.3} m to {:.3} m<", distances[step], distances[step + 1]),
        format!(">on the goal after {arrived} steps<"),
        format!("{:.2} m away in the end", distances[STEPS]),
    ] {
        assert!(svg.contains(&note), "{note}");
    }
}

/// All around: just within the outline an Euler step leads away from the goal, just outside nearer to it,
/// and a stable one approaches it on both sides.
#[test]
fn the_outline_is_where_euler_steps_stop_approaching() {
    let flow = picture::flow().unwrap();
    for degrees in 0..360 {
        let angle = f64::from(degrees).to_radians();
        let away = Vector2::new(angle.cos(), angle.sin());
        let radius = picture::overshoot_radius(flow.source(), &away);
        for (share, approaches) in [(1.0 - 1e-6, false), (1.0 + 1e-6, true)] {
            let from = flow.goal() + away * (share * radius);
            let (state, before) = (State::at(from), flow.attractor().distance(&from));
            let nearer = |next: Vector2<f64>| flow.attractor().distance(&next) < before;
            let euler = Euler.step(&flow, &state, TIME_STEP).unwrap();
            assert_eq!(
                nearer(euler),
                approaches,
                "{degrees} degrees, {share} of {radius} m"
            );
            assert!(nearer(StableEuler.step(&flow, &state, TIME_STEP).unwrap()));
        }
    }
}
