//! Made-up walkers, for measurements where there are no recordings.

use std::ops::Range;

/// Velocities (m/s) of walkers who keep their headings with some sway for a number of steps in `steps`, one in ten of them
/// standing.
pub(crate) fn walkers(count: usize, steps: Range<usize>, seed: u64) -> Vec<Vec<[f64; 2]>> {
    let mut state = seed;
    let mut next = || {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 53) as f64
    };
    (0..count)
        .map(|_| {
            let stands = next() < 0.1;
            let speed = if stands { 0.0 } else { 0.4 + 1.2 * next() };
            let (sin, cos) = (std::f64::consts::TAU * next()).sin_cos();
            let steps = steps.start + (steps.len() as f64 * next()) as usize;
            let mut sway = || 0.1 * (speed + 0.1) * (next() - 0.5);
            (0..steps)
                .map(|_| [speed * cos + sway(), speed * sin + sway()])
                .collect()
        })
        .collect()
}
