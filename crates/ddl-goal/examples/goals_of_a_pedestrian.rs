//! Weighted goals of one pedestrian, estimated from a library of complete tracks.
//!
//! ```text
//! cargo run --release -p ddl-goal --example goals_of_a_pedestrian
//! ```
//! The library is synthetic: at a fork, pedestrians walk straight on, turn left or turn right, at many speeds and in
//! all directions. A new pedestrian, observed for 3.2 s (8 positions), begins to turn left. The goals are for 4.8 s
//! later.
#![expect(clippy::print_stdout, reason = "the example prints its result")]

use std::error::Error;

use ddl_goal::{ExpertLibrary, GoalEstimator, GoalEstimatorParams, TRACK_LENGTH};

const TIME_STEP: f64 = 0.4;

/// A walk of 20 positions (m) at `speed` m/s towards `heading` (rad), which turns by `turn` rad/s after the first 2 s.
fn walk(speed: f64, heading: f64, turn: f64) -> Vec<[f64; 2]> {
    let mut position = [0.0, 0.0];
    let mut track = vec![position];
    for step in 1..TRACK_LENGTH {
        let turned = turn * (TIME_STEP * step as f64 - 2.0).max(0.0);
        let direction = heading + turned.clamp(-1.0, 1.0);
        position[0] += TIME_STEP * speed * direction.cos();
        position[1] += TIME_STEP * speed * direction.sin();
        track.push(position);
    }
    track
}

fn library() -> Result<ExpertLibrary, Box<dyn Error>> {
    let pedestrian = |i: u32| {
        let share = |parts: u32| f64::from(i % parts) / f64::from(parts);
        let turn = 0.35 * (f64::from(i % 3) - 1.0) + 0.1 * (share(7) - 0.5);
        walk(0.8 + 0.8 * share(41), std::f64::consts::TAU * share(97), turn)
    };
    Ok(ExpertLibrary::new((0..3000).map(pedestrian).collect(), TIME_STEP)?)
}

fn main() -> Result<(), Box<dyn Error>> {
    let params = GoalEstimatorParams::default().experts(300).clusters(5).check()?;
    let estimator = GoalEstimator::new(params, library()?)?;

    let whole = walk(1.2, 0.4, 0.35);
    let (observed, end) = (&whole[..8], whole[TRACK_LENGTH - 1]);
    let goals = estimator.estimate(observed)?;

    let [x, y] = observed[7];
    println!(
        "seen for 3.2 s, now at ({x:.2}, {y:.2}) m; {} experts of {} pedestrians give the goals in 4.8 s:",
        estimator.params().experts,
        estimator.library().tracks().len()
    );
    println!("weight         goal (m)  from the true end");
    let off = |[x, y]: [f64; 2]| (x - end[0]).hypot(y - end[1]);
    for (&goal, weight) in goals.goals().iter().zip(goals.weights()) {
        println!("{weight:>6.3} {:>8.2} {:>7.2} {:>16.2} m", goal[0], goal[1], off(goal));
    }
    // The baseline without a library: repeating the last step.
    let straight = [0, 1].map(|axis| observed[7][axis] + 12.0 * (observed[7][axis] - observed[6][axis]));
    println!(
        "nearest goal: {:.2} m from the true end; going straight on: {:.2} m",
        off(goals.goals()[goals.nearest(end)]),
        off(straight)
    );
    Ok(())
}
