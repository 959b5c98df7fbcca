//! The way of a pedestrian past a plan during one leg, in `f32`, for sixteen deviations at a time.

#![expect(clippy::inline_always, reason = "kernels are compiled for the instructions of the processor")]

use super::course::CourseLeg;
use ddl_core::{HORIZON, Position};
use ddl_simd::{LANES, Lanes, Simd};
use fearless_simd::prelude::*;
use std::array::from_fn;

/// What `f32` may be wrong by.
const ROUNDING: f32 = 4e-6;

/// Sixteen deviations.
#[derive(Debug)]
pub(super) struct DeviationBlock {
    offsets: [Lanes; 2],
    /// None is longer.
    pub(super) most: f32,
}

impl DeviationBlock {
    pub(super) fn of(deviations: &[Position; LANES]) -> Self {
        let lanes = |axis: usize| Lanes(from_fn(|lane| deviations[lane][axis] as f32));
        let longest = deviations.iter().map(|[x, y]| x.hypot(*y)).fold(0.0, f64::max);
        Self { offsets: [lanes(0), lanes(1)], most: (longest * (1.0 + f64::from(ROUNDING))) as f32 }
    }
}

/// From the plan to a pedestrian (m) and its scale (m), where the leg begins and what is added until its end; the
/// distance that counts as close.
#[derive(Debug, Clone, Copy)]
pub(super) struct PedestrianWay {
    x: f32,
    y: f32,
    s: f32,
    r: f32,
    dx: f32,
    dy: f32,
    ds: f32,
}

/// A leg of a plan as a pedestrian sees it.
#[derive(Debug)]
pub(super) struct PedestrianCourse {
    /// Where it begins and ends, as shares of the step.
    shares: [f32; 2],
    /// The plan there, metres from the present position of the pedestrian.
    plan: [[f32; 2]; 2],
    scales: [f32; 2],
    reach: f32,
}

impl PedestrianCourse {
    #[inline(always)]
    pub(super) fn new(leg: &CourseLeg, present: Position, scales: &[f64; HORIZON + 1], reach: f64) -> Self {
        Self {
            shares: leg.shares.map(|share| share as f32),
            plan: leg.positions.map(|at| [0, 1].map(|axis| (at[axis] - present[axis]) as f32)),
            scales: leg.scales(scales).map(|scale| scale as f32),
            reach: reach as f32,
        }
    }

    /// Of sixteen hypotheses, from their places at the beginning and at the end of the step.
    #[inline(always)]
    pub(super) fn ways<S: Simd>(&self, simd: S, from: &[Lanes; 2], to: &[Lanes; 2]) -> PedestrianWays<'_> {
        let mut ways =
            PedestrianWays { course: self, offsets: [Lanes::ZERO; 2], moves: [Lanes::ZERO; 2], nearest: Lanes::ZERO };
        for axis in 0..2 {
            let (from, to) = (simd.load(&from[axis].0), simd.load(&to[axis].0));
            let along = to - from;
            let at = |end: usize| from + along * self.shares[end] - self.plan[end][axis];
            let start = at(0);
            simd.store(start, &mut ways.offsets[axis].0);
            simd.store(at(1) - start, &mut ways.moves[axis].0);
        }
        let [x, y] = [simd.load(&ways.offsets[0].0), simd.load(&ways.offsets[1].0)];
        let [dx, dy] = [simd.load(&ways.moves[0].0), simd.load(&ways.moves[1].0)];
        let zero = simd.splat(0.0);
        let share = (zero - (x * dx + y * dy)) / (dx * dx + dy * dy + f32::MIN_POSITIVE);
        let share = share.max(zero).min(simd.splat(1.0));
        let (x, y) = (x + share * dx, y + share * dy);
        simd.store((x * x + y * y) * (1.0 - ROUNDING), &mut ways.nearest.0);
        ways
    }
}

/// Sixteen ways during a leg.
#[derive(Debug)]
pub(super) struct PedestrianWays<'a> {
    course: &'a PedestrianCourse,
    offsets: [Lanes; 2],
    moves: [Lanes; 2],
    /// The least squared distances of the paths themselves, smaller by what `f32` may be wrong by.
    nearest: Lanes,
}

impl PedestrianWays<'_> {
    /// Those on which a deviation may come close, one bit for each, of the longest of each in scales.
    #[inline(always)]
    pub(super) fn within<S: Simd>(&self, simd: S, outermost: &Lanes) -> u64 {
        let [s, s1] = self.course.scales;
        let reach = simd.load(&outermost.0) * s.max(s1) + self.course.reach;
        simd.load(&self.nearest.0).simd_le(reach * reach).to_bitmask()
    }

    #[inline(always)]
    pub(super) fn nearest(&self, lane: usize) -> f32 {
        self.nearest.0[lane]
    }

    #[inline(always)]
    pub(super) fn way(&self, lane: usize) -> PedestrianWay {
        let [x, y, dx, dy] = [&self.offsets[0], &self.offsets[1], &self.moves[0], &self.moves[1]].map(|of| of.0[lane]);
        let [s, s1] = self.course.scales;
        PedestrianWay { x, y, s, r: self.course.reach, dx, dy, ds: s1 - s }
    }
}

impl PedestrianWay {
    /// Without moving on.
    #[inline(always)]
    pub(super) fn at_start(self) -> Self {
        Self { dx: 0.0, dy: 0.0, ds: 0.0, ..self }
    }

    /// The deviations of these blocks, farther out from one to the next, that come close, one bit for each. `nearest`:
    /// the least squared distance of the path itself.
    #[inline(always)]
    pub(super) fn close<S: Simd>(&self, simd: S, blocks: &[DeviationBlock], nearest: f32) -> u64 {
        let most = self.s + self.ds.max(0.0);
        let mut close = 0;
        // The outermost deviations first: further inside none come close if these stay away.
        for (b, block) in blocks.iter().enumerate().rev() {
            let reach = self.r + most * block.most;
            if nearest > reach * reach {
                break;
            }
            close |= self.close_of_block(simd, &block.offsets) << (b * LANES);
        }
        close
    }

    #[inline(always)]
    fn close_of_block<S: Simd>(&self, simd: S, [zx, zy]: &[Lanes; 2]) -> u64 {
        let (zx, zy) = (simd.load(&zx.0), simd.load(&zy.0));
        let (x, y) = (zx.mul_add(self.s, self.x), zy.mul_add(self.s, self.y));
        let (dx, dy) = (zx.mul_add(self.ds, self.dx), zy.mul_add(self.ds, self.dy));
        // Close where a u^2 + 2 b u + c <= 0 for a share u of the leg.
        let a = dx.mul_add(dx, dy * dy);
        let b = x.mul_add(dx, y * dy);
        let c = x.mul_add(x, y.mul_sub(y, self.r * self.r));
        let on_the_way = b.simd_lt(0.0) & (a + b).simd_gt(0.0) & (a * c).simd_le(b * b);
        let is_close = c.simd_le(0.0) | (a + b + b + c).simd_le(0.0) | on_the_way;
        is_close.to_bitmask()
    }
}
