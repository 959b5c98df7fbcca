//! The shape of the walk of who may have only one.
//!
//! What the network shapes is the way to a goal that may be taken for sure. The central goal stands for all goals at once, and on the way there
//! its shape costs more than it is worth (`docs/accuracy.md`, straight to the central goal): P is the same in all directions and at all steps.

use ddl_data::{HORIZON, OBSERVED, Position, Window};

/// (a, b, c) of the factors of P = s I, in (m/s)^(1/2): straight on at the constant speed s (m/s), at the goal with the last step.
///
/// # Shapes
/// `goals` one a pedestrian, metres; `time_step` in seconds -> 12 factors a pedestrian.
///
/// # Numerics
/// sigma comes on top, as everywhere: P = (s + sigma) I, so that P is positive definite where somebody stays.
pub(crate) fn factors(window: &Window, goals: &[Position], time_step: f64) -> Vec<[f64; 3]> {
    let of_walker = |(i, goal): (usize, &Position)| {
        let start = window.observed(i)[OBSERVED - 1];
        let distance = (goal[0] - start[0]).hypot(goal[1] - start[1]);
        let root = (distance / (HORIZON as f64 * time_step)).sqrt();
        [[root, 0.0, root]; HORIZON]
    };
    goals.iter().enumerate().flat_map(of_walker).collect()
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a test may panic")]

    use super::*;
    use crate::walk::Course;
    use ddl_data::PedestrianId;

    /// 9.6 m in 4.8 s are 2 m/s; who has arrived stays.
    #[test]
    fn as_fast_as_the_goal_is_far() {
        let (ids, stands) = (vec![PedestrianId(1), PedestrianId(2)], vec![[1.0, 2.0]; 8]);
        let window = Window::new("yard", 0, 1, ids, vec![stands; 2]).unwrap();
        let goals = [[1.0, -7.6], [1.0, 2.0]];
        let factors = factors(&window, &goals, 0.4);
        assert_eq!(factors.len(), 2 * HORIZON);
        assert!((factors[0][0].powi(2) - 2.0).abs() < 1e-12);
        for (goal, factors) in goals.into_iter().zip(factors.chunks(HORIZON)) {
            let course = Course {
                start: [1.0, 2.0],
                goal,
                sigma: 1e-8,
                time_step: 0.4,
            };
            let walk = course.walk(factors).unwrap();
            assert_eq!(walk.certificate.holds(), Ok(()));
            for (t, [x, y]) in (1..).zip(walk.positions) {
                let right = 2.0 + f64::from(t) / 12.0 * (goal[1] - 2.0);
                assert!(
                    (x - 1.0).abs() < 1e-12 && (y - right).abs() < 1e-6,
                    "{t}: {x} {y}"
                );
            }
        }
    }
}
