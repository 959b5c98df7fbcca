//! The unit of length of the networks' inputs: one metre for a walking pedestrian, more for a running one.
//!
//! With the mean speed `v` of the observed steps, the unit is `(1 + (v / 2 m/s)^4)^(1/4)` metres. Up to walking speed it
//! is a metre; far above it is v / (2 m/s) metres, so that the network sees a runner as a pedestrian of almost
//! 2 m/s. It is a smooth function of the speed: so are the forecasts.

use ddl_data::Position;
use tch::{Kind, Tensor};

/// Speed (m/s) around which the unit begins to grow: the fastest that training recordings hold many examples of.
const FAST_WALK: f64 = 2.0;

/// The unit of a pedestrian (m) from its observed positions (m), `time_step` seconds apart; 1 for fewer than two.
///
/// # Examples
/// ```
/// let at = |speed: f64| (0..8).map(|t| [0.4 * speed * f64::from(t), 0.0]).collect::<Vec<_>>();
/// assert!((ddl_star::motion_unit(&at(1.0), 0.4) - 1.0).abs() < 0.02); // a walker
/// assert!((ddl_star::motion_unit(&at(6.0), 0.4) - 3.0).abs() < 0.02); // a runner
/// ```
#[must_use]
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

/// [`motion_unit`] of everybody in a batch.
///
/// # Shapes
/// `observed` `[T, P, 2]` -> `[1, P, 1]`.
pub(crate) fn of_tensor(observed: &Tensor, time_step: f64) -> Tensor {
    let steps = step_lengths(observed);
    let relative = steps.mean_dim([0i64].as_slice(), true, None::<Kind>) / (time_step * FAST_WALK);
    let larger = relative.clamp_min(1.0);
    &larger
        * (larger.pow_tensor_scalar(-4) + (relative / &larger).pow_tensor_scalar(4))
            .pow_tensor_scalar(0.25)
}

/// Lengths of the steps between positions, metres.
///
/// # Shapes
/// `[T, P, 2]` -> `[T - 1, P, 1]`.
pub(crate) fn step_lengths(positions: &Tensor) -> Tensor {
    let steps = positions.size()[0] - 1;
    let moved = positions.narrow(0, 1, steps) - positions.narrow(0, 0, steps);
    moved.norm_scalaropt_dim(2, [-1i64].as_slice(), true)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// Both ways agree, at every speed; and a runner's speed in its own units stays below 2 m/s.
        #[test]
        fn the_unit_of_a_tensor_is_that_of_its_positions(
            track in prop::collection::vec([-3.0..3.0f64, -3.0..3.0f64], 8),
            scale in -6.0..6.0f64,
        ) {
            let track: Vec<Position> = track.iter().map(|p| p.map(|x| x * 10f64.powf(scale))).collect();
            let tensor = Tensor::from_slice(track.as_flattened()).reshape([8, 1, 2]);
            let unit = motion_unit(&track, 0.4);
            let other = of_tensor(&tensor, 0.4).double_value(&[0, 0, 0]);
            prop_assert!((unit / other - 1.0).abs() < 1e-12 && unit >= 1.0);
            let speed = step_lengths(&tensor).mean(Kind::Double).double_value(&[]) / 0.4;
            prop_assert!(speed / unit <= FAST_WALK * (1.0 + 1e-12));
        }
    }
}
