//! The unit of length of the networks' inputs: `(1 + (v / 2 m/s)^4)^(1/4)` metres for the mean observed speed `v`. A metre
//! up to walking speed, v / (2 m/s) metres far above it: the network sees a runner as a fast walker.

use ddl_data::Position;

/// Speed (m/s) around which the unit begins to grow: the fastest that training recordings hold many examples of.
const FAST_WALK: f64 = 2.0;

/// The unit of a pedestrian (m) from its observed positions (m), `time_step` seconds apart; 1 for fewer than two.
///
/// # Examples
/// ```
/// let at = |speed: f64| (0..8).map(|t| [0.4 * speed * f64::from(t), 0.0]).collect::<Vec<_>>();
/// assert!((ddl_network::motion_unit(&at(1.0), 0.4) - 1.0).abs() < 0.02); // walking
/// assert!((ddl_network::motion_unit(&at(6.0), 0.4) - 3.0).abs() < 0.02); // running
/// ```
pub fn motion_unit(observed: &[Position], time_step: f64) -> f64 {
    let steps = observed.len().saturating_sub(1).max(1) as f64;
    let way: f64 = observed
        .windows(2)
        .map(|pair| (pair[1][0] - pair[0][0]).hypot(pair[1][1] - pair[0][1]))
        .sum();
    let relative = way / (steps * time_step * FAST_WALK);
    // Divided by the larger of the two first: the fourth power of a large number overflows.
    let larger = relative.max(1.0);
    larger * (larger.powi(-4) + (relative / larger).powi(4)).powf(0.25)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// A runner's speed in its own units stays below 2 m/s, at every scale.
        #[test]
        fn nobody_is_faster_than_a_fast_walk_in_its_own_units(
            track in prop::collection::vec([-3.0..3.0f64, -3.0..3.0f64], 8),
            scale in -6.0..6.0f64,
        ) {
            let track: Vec<Position> = track.iter().map(|p| p.map(|x| x * 10f64.powf(scale))).collect();
            let unit = motion_unit(&track, 0.4);
            let lengths = track.windows(2).map(|p| (p[1][0] - p[0][0]).hypot(p[1][1] - p[0][1]));
            let speed = lengths.sum::<f64>() / 7.0 / 0.4;
            prop_assert!(unit >= 1.0 && speed / unit <= FAST_WALK * (1.0 + 1e-12));
        }
    }
}
