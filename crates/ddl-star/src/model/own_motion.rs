//! The observed motion of every pedestrian: [`length_unit`](ddl_network::length_unit) and
//! [`motion_bounds`](ddl_network::motion_bounds) on tensors.

use ddl_core::motion::{FAST_WALK, JITTER, RECENT_STEPS};
use ddl_dynamics::MotionBounds;
use tch::{Kind, Tensor};

/// Units of length of all pedestrians in a batch, metres. Shapes: `observed` `[T, P, 2]` -> `[1, P, 1]`.
pub(crate) fn units(observed: &Tensor, time_step: f64) -> Tensor {
    let relative = step_lengths(observed).mean_dim([0i64].as_slice(), true, None::<Kind>) / (time_step * FAST_WALK);
    let larger = relative.clamp_min(1.0);
    &larger * (larger.pow_tensor_scalar(-4) + (relative / &larger).pow_tensor_scalar(4)).pow_tensor_scalar(0.25)
}

/// Lengths of the steps between positions, metres.
/// Shapes: `[T, P, 2]` -> `[T - 1, P, 1]`.
pub(crate) fn step_lengths(positions: &Tensor) -> Tensor {
    let steps = positions.size()[0] - 1;
    let moved = positions.narrow(0, 1, steps) - positions.narrow(0, 0, steps);
    moved.norm_scalaropt_dim(2, [-1i64].as_slice(), true)
}

/// Top speeds of all pedestrians in a batch, m/s.
/// Shapes: `observed` `[T, P, 2]` -> `[1, P, 1]`.
pub(crate) fn top_speeds(observed: &Tensor, time_step: f64) -> Tensor {
    let fastest = step_lengths(observed).amax([0i64].as_slice(), true) / time_step;
    (fastest * MotionBounds::<f64>::TOP_SPEED_FACTOR + MotionBounds::<f64>::SPEED_MARGIN)
        .clamp_min(MotionBounds::<f64>::LEAST_TOP_SPEED)
}

/// Own velocities of all pedestrians in a batch, m/s.
/// Shapes: `observed` `[T, P, 2]`, T at least 4 -> `[1, P, 2]`.
pub(crate) fn velocities(observed: &Tensor, time_step: f64) -> Tensor {
    let frames = observed.size()[0];
    let steps = observed.narrow(0, 1, frames - 1) - observed.narrow(0, 0, frames - 1);
    let tremble = step_lengths(&steps).mean_dim([0i64].as_slice(), true, None::<Kind>);
    let recent = steps.narrow(0, frames - 1 - RECENT_STEPS as i64, RECENT_STEPS as i64);
    let mean = recent.mean_dim([0i64].as_slice(), true, None::<Kind>);
    let even = (-(tremble / JITTER).square()).exp();
    let last = steps.narrow(0, frames - 2, 1);
    (&mean + (last - &mean) * even) / time_step
}

#[cfg(test)]
mod tests {
    use super::*;
    use ddl_core::Position;
    use ddl_network::{length_unit, motion_bounds};
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn tensors_and_positions_agree(
            track in prop::collection::vec([-0.2..0.2f64, -0.2..0.2f64], 8),
            [vx, vy] in [-4.0..4.0f64, -4.0..4.0f64],
            tremble in 0.0..1.0f64,
            scale in -6.0..6.0f64,
        ) {
            let trembling = |(t, p): (usize, &[f64; 2])| {
                let time = 0.4 * t as f64;
                [vx * time + tremble * p[0], vy * time + tremble * p[1]]
            };
            let track: Vec<Position> = track.iter().enumerate().map(trembling).collect();
            let tensor = Tensor::from_slice(track.as_flattened()).reshape([8, 1, 2]);
            let top = top_speeds(&tensor, 0.4).double_value(&[0, 0, 0]);
            let velocity = [0, 1].map(|axis| velocities(&tensor, 0.4).double_value(&[0, 0, axis]));
            let bounds = motion_bounds(&track, 0.4, 0.5);
            let other = MotionBounds::new(top, velocity.into(), 0.5).unwrap();
            prop_assert!((bounds.top_speed() - other.top_speed()).abs() < 1e-12);
            prop_assert!((bounds.velocity() - other.velocity()).norm() < 1e-12);
            let scaled: Vec<Position> = track.iter().map(|p| p.map(|x| x * 10f64.powf(scale))).collect();
            let tensor = Tensor::from_slice(scaled.as_flattened()).reshape([8, 1, 2]);
            let unit = units(&tensor, 0.4).double_value(&[0, 0, 0]);
            prop_assert!((length_unit(&scaled, 0.4) / unit - 1.0).abs() < 1e-12);
        }
    }
}
