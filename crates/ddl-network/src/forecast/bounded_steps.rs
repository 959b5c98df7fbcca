//! Bounded steps of many pedestrians, sixteen at a time.
//!
//! A step is a chain of square roots and divisions, each of which waits for the one before. With a pedestrian in each
//! lane, sixteen chains take hardly longer than one. The operations are those of `MotionBounds::shape` and
//! `StableEuler` in `ddl-dynamics`, in the same order and each rounded once, so the results have the same bits. Lanes
//! that leave the usual branches there, for instance at the goal or with extreme numbers, are computed by
//! `ddl-dynamics` itself.

#![expect(clippy::inline_always, reason = "compiled per instruction set")]

use crate::forecast::one_step::{around, next};
use ddl_dynamics::{MotionBounds, StepTime};
use ddl_simd::{Floats, Kernel, LANES, Lanes, Simd};
use fearless_simd::mask32x16;
use fearless_simd::prelude::*;

/// Sum of the squares of a row's numbers up to which every sum and product but a square is finite.
const LARGEST: f32 = 1e16;
/// Smallest square of a vector that `ddl-dynamics` does not scale first.
const SMALLEST_SQUARE: f32 = f32::MIN_POSITIVE / f32::EPSILON;
/// Distance in rounding errors within which a step ends on the goal.
const ARRIVAL: f32 = 8.0;
/// Numbers of a row: position, goal, factor, velocity, top speed and share.
const INPUTS: usize = 11;

/// Moves the pedestrians one step, within bounds that are relative to the neutral motion.
pub(super) struct BoundedSteps<'a> {
    /// `[H, P]`.
    pub(super) positions: &'a mut [[f32; 2]],
    /// `[1 or H, P]`.
    pub(super) goals: &'a [[f32; 2]],
    /// `[H, P]`, in the frame of the world.
    pub(super) factors: &'a [[f32; 3]],
    /// `[P]`.
    pub(super) bounds: &'a [MotionBounds<f32>],
    pub(super) sigma: f32,
    pub(super) time: StepTime<f32>,
}

impl Kernel for BoundedSteps<'_> {
    #[inline(always)]
    fn run<S: Simd>(self, simd: S) {
        let (sigma, time) = (self.sigma, self.time);
        let mut further = self.goals.iter().cycle().zip(self.bounds.iter().cycle());
        let groups = self.positions.chunks_mut(LANES).zip(self.factors.chunks(LANES));
        for (group, (positions, factors)) in groups.enumerate() {
            let mut rows = [Lanes::ZERO; INPUTS];
            for (l, ((&[px, py], &[a, b, c]), (&[gx, gy], bounds))) in
                positions.iter().zip(factors).zip(&mut further).enumerate()
            {
                let (v, top, share) = (bounds.velocity(), bounds.top_speed(), bounds.share());
                let row = [px, py, gx, gy, a, b, c, v.x, v.y, top, share];
                for (lanes, number) in rows.iter_mut().zip(row) {
                    lanes.0[l] = number;
                }
            }
            let mut ends = [Lanes::ZERO; 2];
            let exact = step(simd, &rows, (sigma, time), &mut ends);
            for (l, (position, factor)) in positions.iter_mut().zip(factors).enumerate() {
                let i = group * LANES + l;
                *position = if exact >> l & 1 == 1 {
                    [ends[0].0[l], ends[1].0[l]]
                } else {
                    let bounds = Some(&self.bounds[i % self.bounds.len()]);
                    next(*position, around(self.goals, i), *factor, (sigma, time), bounds)
                };
            }
        }
    }
}

/// Writes the ends of the steps, and returns in which lanes they are exact.
#[inline(always)]
fn step<S: Simd>(simd: S, rows: &[Lanes; INPUTS], (sigma, time): (f32, StepTime<f32>), ends: &mut [Lanes; 2]) -> u32 {
    let mut numbers = [simd.load(&rows[0].0); INPUTS];
    let mut squares = numbers[0] * 0.0;
    for (number, lanes) in numbers.iter_mut().zip(rows) {
        *number = simd.load(&lanes.0);
        squares += *number * *number;
    }
    let [px, py, gx, gy, a, b, c, vx, vy, top, share] = numbers;
    let zero = simd.splat(0.0);
    let mut exact = lane_bits(squares.simd_le(LARGEST));
    if !((1e-3..1e3).contains(&time.dt) && sigma > 0.0 && sigma < 1e3) {
        exact = 0;
    }

    let (distance, [cos, sin]) = polar([gx - px, gy - py], &mut exact);
    let (s, range) = speeds(distance, top, time);
    let neutral = neutral(s, [cos, sin], [vx, vy], range, time);
    let neutral = within(neutral, range, &mut exact);
    // The sums begin with 0 as in `ddl-dynamics`, which changes the sign of a zero.
    let given = [a * a + sigma - 1.0, a * b + 0.0, b * b + sigma + c * c - 1.0];
    let mut mixed = neutral;
    for i in 0..3 {
        mixed[i] = neutral[i] + given[i] * s;
    }
    mixed = within(mixed, range, &mut exact);
    for i in 0..3 {
        mixed[i] = neutral[i] + (mixed[i] - neutral[i]) * share;
    }
    let ([first, second], double) = axes(mixed, range, &mut exact);
    let axis = half_angle(simd, double, &mut exact);
    let stretch = (first - second).max(zero).sqrt();
    let [x, y] = [axis[0] * stretch, axis[1] * stretch];

    let away = [(px - gx) / distance, (py - gy) / distance];
    let projected = x * away[0] + 0.0 + y * away[1];
    let velocity = [(x * projected + 0.0 + second * away[0]) * -1.0, (y * projected + 0.0 + second * away[1]) * -1.0];
    let (speed, heading) = polar(velocity, &mut exact);
    let cosine = (away[0] * heading[0] + away[1] * heading[1]) * -1.0;
    let reach = distance * cosine;
    let moved = speed * time.dt;
    let unlimited = reach.simd_ge(moved);
    let x = unlimited.select(px + velocity[0] * time.dt, px + heading[0] * reach);
    let y = unlimited.select(py + velocity[1] * time.dt, py + heading[1] * reach);
    let (left, _) = polar([x - gx, y - gy], &mut exact);
    exact &= lane_bits(left.simd_ge(zero)) & !lane_bits(left.simd_ge(distance)) & !lane_bits(cosine.simd_le(zero));

    let largest = magnitude(px).max(magnitude(py)).max(magnitude(gx)).max(magnitude(gy));
    let resolution = (largest * f32::EPSILON).max(f32::MIN_POSITIVE);
    // A step that is not limited by the closest point counts as one that ends far from the goal.
    let left = unlimited.select(simd.splat(f32::INFINITY), left);
    let arrival = resolution * ARRIVAL;
    let arrived = arrival.simd_ge(left);
    simd.store(arrived.select(gx, x), &mut ends[0].0);
    simd.store(arrived.select(gy, y), &mut ends[1].0);
    exact
}

/// The arriving speed, and the range of the eigenvalues.
#[inline(always)]
fn speeds<S: Simd>(distance: Floats<S>, top: Floats<S>, time: StepTime<f32>) -> (Floats<S>, [Floats<S>; 2]) {
    let s = distance / (time.left.max(1) as f32 * time.dt);
    let s = s.min(top).max(f32::MIN_POSITIVE);
    if time.left <= 1 {
        return (s, [s, s]);
    }
    let (reach, later) = (distance / time.dt, top * (time.left - 1) as f32);
    let slowest = s * MotionBounds::<f32>::MIN_SPEED_RATIO as f32;
    let fastest = s * MotionBounds::<f32>::MAX_SPEED_RATIO as f32;
    (s, [slowest.max(reach - later).min(s), fastest.min(reach).min(top).max(s)])
}

/// The neutral metric before its eigenvalues are brought within the range.
#[inline(always)]
fn neutral<S: Simd>(
    s: Floats<S>,
    [cos, sin]: [Floats<S>; 2],
    [vx, vy]: [Floats<S>; 2],
    range: [Floats<S>; 2],
    time: StepTime<f32>,
) -> [Floats<S>; 3] {
    let g = MotionBounds::<f32>::momentum(time) as f32;
    let along = (s * (1.0 - g) + (vx * cos + vy * sin) * g).max(range[0]);
    let most = along * MotionBounds::<f32>::MAX_LATERAL_RATIO as f32;
    let across = ((cos * vy - sin * vx) * g).max(most * -1.0).min(most);
    let r = along + across / along * across * 2.0;
    let twice = across + across;
    [
        along * cos * cos - twice * cos * sin + r * sin * sin,
        (along - r) * cos * sin + across * (cos * cos - sin * sin),
        along * sin * sin + twice * cos * sin + r * cos * cos,
    ]
}

#[inline(always)]
fn magnitude<S: Simd>(number: Floats<S>) -> Floats<S> {
    number.max(number * -1.0)
}

/// Length and direction of a vector. Clears the bits of the lanes where it has to be scaled first.
#[inline(always)]
fn polar<S: Simd>([x, y]: [Floats<S>; 2], exact: &mut u32) -> (Floats<S>, [Floats<S>; 2]) {
    let square = x * x + y * y;
    let usual = lane_bits(square.simd_ge(SMALLEST_SQUARE)) & lane_bits(square.simd_le(f32::MAX));
    *exact &= usual | lane_bits(magnitude(x).max(magnitude(y)).simd_le(0.0));
    let length = square.sqrt();
    // The zero vector has the direction 0.
    let none = square.simd_le(0.0);
    (length, [none.select(square, x / length), none.select(square, y / length)])
}

/// The eigenvalues of a symmetric matrix, brought within the range, the larger one first; and the direction at twice
/// the angle of its eigenvector.
#[inline(always)]
fn axes<S: Simd>(
    [xx, xy, yy]: [Floats<S>; 3],
    [smallest, largest]: [Floats<S>; 2],
    exact: &mut u32,
) -> ([Floats<S>; 2], [Floats<S>; 2]) {
    let (mean, half) = (xx * 0.5 + yy * 0.5, xx * 0.5 - yy * 0.5);
    let (radius, double) = polar([half, xy], exact);
    let first = (mean + radius).max(smallest).min(largest);
    ([first, (mean - radius).max(smallest).min(largest)], double)
}

/// Cosine and sine of half the angle with this cosine and sine.
#[inline(always)]
fn half_angle<S: Simd>(simd: S, [cos, sin]: [Floats<S>; 2], exact: &mut u32) -> [Floats<S>; 2] {
    let ahead = cos.simd_ge(simd.splat(0.0));
    let x = ahead.select(cos + 1.0, sin);
    polar([x, ahead.select(sin, simd.splat(1.0) - cos)], exact).1
}

#[inline(always)]
fn within<S: Simd>(matrix: [Floats<S>; 3], range: [Floats<S>; 2], exact: &mut u32) -> [Floats<S>; 3] {
    let ([first, second], [cos, sin]) = axes(matrix, range, exact);
    let (middle, half) = (first * 0.5 + second * 0.5, first * 0.5 - second * 0.5);
    [middle + half * cos, half * sin, middle - half * cos]
}

/// Bit l is set where the mask is in lane l.
#[inline(always)]
fn lane_bits<S: Simd>(mask: mask32x16<S>) -> u32 {
    mask.to_bitmask() as u32
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a test may panic")]

    use super::*;
    use ddl_simd::{Dispatch, InstructionSet};
    use nalgebra::Vector2;
    use proptest::prelude::*;

    /// Position, way to the goal, factor, and velocity, top speed and share of the bounds.
    type Row = ([f32; 2], [f32; 2], [f32; 3], ([f32; 2], f32, f32));

    fn coordinate() -> impl Strategy<Value = f32> {
        let scales = prop::sample::select(vec![0.0, 1e-42, 1e-30, 1e-12, 1e-6, 1e6, 1e20, 1e38]);
        prop_oneof![6 => -9.0..9.0_f32, 1 => (-2.0..2.0_f32, scales).prop_map(|(x, scale)| x * scale)]
    }

    fn row() -> impl Strategy<Value = Row> {
        let pair = || [coordinate(), coordinate()];
        let bad = prop::sample::select(vec![0.0, -0.0, f32::NAN, f32::INFINITY]);
        let entry = prop_oneof![9 => coordinate(), 1 => bad];
        let factor = prop_oneof![
            3 => [-2.0..2.0_f32, -2.0..2.0_f32, -2.0..2.0_f32],
            1 => prop::array::uniform3(entry),
            1 => Just([0.0; 3]),
        ];
        let share = prop_oneof![0.0..=1.0_f32, Just(0.0), Just(1.0)];
        (pair(), pair(), factor, (pair(), 0.1..9.0_f32, share))
    }

    fn moved(set: InstructionSet, rows: &[Row], goals: &[[f32; 2]], time: StepTime<f32>) -> Vec<[u32; 2]> {
        let mut positions: Vec<_> = rows.iter().map(|row| row.0).collect();
        let factors: Vec<_> = rows.iter().map(|row| row.2).collect();
        Dispatch::new(set).unwrap().run(BoundedSteps {
            positions: &mut positions,
            goals,
            factors: &factors,
            bounds: &bounds(rows),
            sigma: 1e-8,
            time,
        });
        positions.into_iter().map(|place| place.map(f32::to_bits)).collect()
    }

    fn bounds(rows: &[Row]) -> Vec<MotionBounds<f32>> {
        let bounds = rows
            .iter()
            .map(|&(_, _, _, (velocity, top, share))| MotionBounds::new(top, Vector2::from(velocity), share).unwrap());
        bounds.collect()
    }

    proptest! {
        #![proptest_config(ProptestConfig { failure_persistence: None, cases: 2000, ..ProptestConfig::default() })]

        #[test]
        fn steps_have_the_bits_of_the_dynamics(
            rows in prop::collection::vec(row(), 1..40),
            (done, left) in (0..12_usize, prop_oneof![0..3_usize, 0..13_usize]),
            dt in prop_oneof![9 => Just(0.4_f32), 1 => 1e-6..2e3_f32],
        ) {
            let time = StepTime { done, left, dt };
            let goal = |(position, way, ..): &Row| [position[0] + way[0], position[1] + way[1]];
            let goals: Vec<_> = rows.iter().map(goal).collect();
            let steps = rows.iter().zip(&goals).zip(bounds(&rows));
            prop_assume!(goals.iter().all(|goal: &[f32; 2]| goal.iter().all(|x| x.is_finite())));
            let expected: Vec<_> = steps
                .map(|((row, &goal), bounds)| next(row.0, goal, row.2, (1e-8, time), Some(&bounds)).map(f32::to_bits))
                .collect();
            for set in InstructionSet::available() {
                prop_assert_eq!(&moved(set, &rows, &goals, time), &expected, "{:?}", set);
            }
        }
    }

    /// The lanes that are exact after usual steps.
    struct Usual<'a>(StepTime<f32>, &'a mut u32);

    impl Kernel for Usual<'_> {
        #[inline(always)]
        fn run<S: Simd>(self, simd: S) {
            let row = [1.0, 2.0, 4.0, -1.5, 1.1, 0.2, 0.9, 0.8, -0.3, 2.15, 0.6].map(|number| Lanes([number; LANES]));
            *self.1 = step(simd, &row, (1e-8, self.0), &mut [Lanes::ZERO; 2]);
        }
    }

    #[test]
    fn usual_steps_are_computed_in_lanes() {
        for set in InstructionSet::available() {
            for done in 0..12 {
                let mut exact = 0;
                let time = StepTime { done, left: 12 - done, dt: 0.4 };
                Dispatch::new(set).unwrap().run(Usual(time, &mut exact));
                assert_eq!(exact & 0xffff, 0xffff, "{set:?}, {done}");
            }
        }
    }
}
