//! The picture of `docs/stability.md` is the one that the example draws, and shows what the rollouts do.

#[path = "../../examples/circling/picture/mod.rs"]
mod picture;

use super::svg::{PIXEL, circles};
use ddl_dynamics::{Euler, Integrator, StableEuler, State};
use nalgebra::{Matrix2, Vector2};
use picture::{DISTANCES, NEAR, STEPS, Scene, TIME_STEP, WHOLE};

fn drawn() -> String {
    picture::draw(&Scene::new().unwrap()).unwrap()
}

/// The walk worked out again with `P` multiplied out by hand: L = [1.1 0; 0.4 1.1].
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
fn the_committed_picture_is_up_to_date() {
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/stability.svg");
    let committed = std::fs::read_to_string(file).unwrap();
    assert!(
        committed == drawn(),
        "draw it anew: cargo run -p ddl-dynamics --example circling -- docs/stability.svg"
    );
}

#[test]
fn positions_are_drawn_where_the_walkers_are() {
    let svg = drawn();
    for (name, is_stable) in [("euler", false), ("stable", true)] {
        let path = expected(is_stable);
        for (plot, plane) in [("whole", WHOLE), ("near", NEAR)] {
            let circles = circles(&svg, &format!("{plot}-{name}"));
            assert_eq!(circles.len(), STEPS + 1);
            for (circle, position) in circles.iter().zip(&path) {
                let [x, y] = plane.origin;
                let found = Vector2::new(
                    plane.corner[0] + (circle[0] - x) / plane.scale,
                    plane.corner[1] - (circle[1] - y) / plane.scale,
                );
                let off = (found - position).amax() * plane.scale;
                assert!(off < PIXEL, "{plot}, {name}: {found} for {position}");
            }
        }
    }
}

#[test]
fn distances_are_drawn_on_their_decades_and_zero_below_all() {
    let svg = drawn();
    let [[_, top], [_, bottom]] = DISTANCES.frame;
    for (name, is_stable) in [("euler", false), ("stable", true)] {
        let circles = circles(&svg, &format!("distance-{name}"));
        assert_eq!(circles.len(), STEPS + 1);
        for (circle, position) in circles.iter().zip(expected(is_stable)) {
            let distance = (position - Vector2::new(4.0, 0.0)).norm();
            // from the upper edge, 10 m, to the lower one in 18.5 decades
            let decades = (circle[1] - top) / (bottom - top) * 18.5;
            if distance > 1e-12 {
                let found = 10_f64.powf(1.0 - decades);
                assert!(
                    (found / distance - 1.0).abs() < 1e-3,
                    "{found} m, {distance} m"
                );
            } else if distance > 0.0 {
                // all rounding, but above 0
                assert!((12.5..17.0).contains(&decades), "{decades}");
            } else {
                assert!(decades > 17.5, "{decades}");
            }
        }
    }
}

#[test]
fn the_notes_say_what_the_rollouts_do() {
    let svg = drawn();
    let goal = Vector2::new(4.0, 0.0);
    let distances: Vec<_> = expected(false).iter().map(|p| (p - goal).norm()).collect();
    let rises = |step: &usize| distances[step + 1] >= distances[*step];
    let step = (0..STEPS).find(rises).unwrap();
    let (before, after) = (distances[step], distances[step + 1]);
    let arrived = expected(true).iter().position(|p| *p == goal).unwrap();
    for note in [
        format!(">step {step} is the first<"),
        format!(">{before:.3} m to {after:.3} m<"),
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
    let scene = Scene::new().unwrap();
    let flow = ddl_dynamics::NaturalGradientFlow::new(scene.attractor, scene.metric);
    for degrees in 0..360 {
        let angle = f64::from(degrees).to_radians();
        let away = Vector2::new(angle.cos(), angle.sin());
        let radius = scene.overshoot_radius(&away);
        for (share, approaches) in [(1.0 - 1e-6, false), (1.0 + 1e-6, true)] {
            let from = scene.attractor.goal() + away * (share * radius);
            let state = State::at(from);
            let before = scene.attractor.potential(&from);
            let euler = Euler.step(&flow, &state, TIME_STEP).unwrap();
            assert_eq!(
                scene.attractor.potential(&euler) < before,
                approaches,
                "{degrees} degrees, {share} of {radius} m"
            );
            let stable = StableEuler.step(&flow, &state, TIME_STEP).unwrap();
            assert!(scene.attractor.potential(&stable) < before);
        }
    }
}

#[test]
fn readers_who_do_not_see_it_are_told_what_it_shows() {
    let svg = drawn();
    for element in ["<title id=", "<desc id=", "role=\"img\""] {
        assert!(svg.contains(element), "{element}");
    }
}
