//! The shape of the walk of who may have only one.
//!
//! What the network shapes is the way to a goal that may be taken for sure. The central goal stands for all goals at once, and on the way there
//! nothing that was learned pays (`docs/accuracy.md`, one forecast): P is the same in all directions and at all steps.

use ddl_data::{HORIZON, OBSERVED, Position, Window};

/// (a, b, c) of the factors of P = s I, in (m/s)^(1/2): straight on at the constant speed s (m/s), at the goal with the last step.
///
/// # Shapes
/// `goals` one a pedestrian, metres; `time_step` in seconds -> 12 factors a pedestrian.
pub(crate) fn factors(window: &Window, goals: &[Position], time_step: f64) -> Vec<[f64; 3]> {
    let of_walker = |(i, goal): (usize, &Position)| {
        let start = window.observed(i)[OBSERVED - 1];
        let distance = (goal[0] - start[0]).hypot(goal[1] - start[1]);
        let root = (distance / (HORIZON as f64 * time_step)).sqrt();
        [[root, 0.0, root]; HORIZON]
    };
    goals.iter().enumerate().flat_map(of_walker).collect()
}
