//! The bounds of a pedestrian's motion from its observed positions: its top speed and its present velocity.

use ddl_core::Position;
use ddl_core::motion::{JITTER, RECENT_STEPS};
use ddl_dynamics::MotionBounds;
use nalgebra::Vector2;

/// The bounds of the motion of a pedestrian observed at these positions (m), `time_step` seconds apart. `share` is the
/// share of the network's metric: it is clamped to 0..1, and NaN counts as 0.
///
/// The present velocity is that of the last step if the steps are even, and the mean of the last three if the positions
/// jitter. With w the mean length of the second differences, the last step has the weight exp(-(w / 6 cm)^2).
pub fn motion_bounds(observed: &[Position], time_step: f64, share: f64) -> MotionBounds<f64> {
    let points: Vec<Vector2<f64>> = observed.iter().map(|&p| p.into()).collect();
    let steps: Vec<Vector2<f64>> = points.array_windows().map(|[a, b]| b - a).collect();
    let Some(&last) = steps.last() else { return MotionBounds::default() };
    let fastest = steps.iter().map(Vector2::norm).fold(0.0, f64::max) / time_step;
    let changes = steps.array_windows().map(|[a, b]| (b - a).norm());
    let tremble = changes.clone().sum::<f64>() / changes.len().max(1) as f64;
    let recent = &steps[steps.len().saturating_sub(RECENT_STEPS)..];
    let mean = recent.iter().sum::<Vector2<f64>>() / recent.len() as f64;
    let even = (-(tremble / JITTER).powi(2)).exp();
    let velocity = (mean + (last - mean) * even) / time_step;
    let share = if share.is_nan() { 0.0 } else { share.clamp(0.0, 1.0) };
    MotionBounds::new(MotionBounds::top_speed_after(fastest), velocity, share).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_velocity_is_of_the_last_step_or_of_the_last_three_with_jitter() {
        let even: Vec<Position> = (0..8).map(|t| [0.4 * f64::from(t), 1.0]).collect();
        let bounds = motion_bounds(&even, 0.4, 1.0);
        assert!((bounds.velocity() - Vector2::new(1.0, 0.0)).norm() < 1e-12);
        assert!((bounds.top_speed() - 2.15).abs() < 1e-12);
        let mut askew = even;
        for (t, p) in askew.iter_mut().enumerate() {
            p[1] += if t % 2 == 0 { 3.0 } else { 0.0 };
        }
        // The last three steps go 3 m up, down and up again in 1.2 s.
        let velocity = motion_bounds(&askew, 0.4, 1.0).velocity();
        assert!((velocity - Vector2::new(1.0, -3.0 / 1.2)).norm() < 1e-9);
        // A share out of range does not change the top speed of a runner.
        let runner: Vec<Position> = (0..8).map(|t| [2.4 * f64::from(t), 0.0]).collect();
        for (share, clamped) in [(1.000_000_1, 1.0), (-1.0, 0.0), (f64::NAN, 0.0)] {
            assert_eq!(motion_bounds(&runner, 0.4, share), motion_bounds(&runner, 0.4, clamped));
        }
        assert_eq!(motion_bounds(&[[1.0, 2.0]], 0.4, 1.0), MotionBounds::default());
    }
}
