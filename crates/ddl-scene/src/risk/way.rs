//! The way of a pedestrian past a plan during one leg, in `f32`, for sixteen deviations at a time.

#![expect(clippy::inline_always, reason = "kernels are compiled for the instructions of the processor")]

use super::course::LegApproach;
use super::quadrature::DeviationBlocks;
use ddl_simd::{LANES, Lanes, Simd};
use fearless_simd::prelude::*;

/// What `f32` may be wrong by.
const ROUNDING: f32 = 4e-6;

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

/// Sixteen ways.
#[derive(Debug, Clone)]
pub(super) struct PedestrianWays {
    x: Lanes,
    y: Lanes,
    s: Lanes,
    r: Lanes,
    dx: Lanes,
    dy: Lanes,
    ds: Lanes,
}

impl Default for PedestrianWays {
    fn default() -> Self {
        let [x, y, s, r, dx, dy, ds] = [Lanes::ZERO; 7];
        Self { x, y, s, r, dx, dy, ds }
    }
}

impl PedestrianWays {
    #[inline(always)]
    pub(super) fn set(&mut self, lane: usize, LegApproach { offsets, scales }: LegApproach, reach: f64) {
        let [[x, y], [x1, y1]] = offsets.map(|offset| offset.map(|number| number as f32));
        let [s, s1] = scales.map(|scale| scale as f32);
        (self.x.0[lane], self.y.0[lane], self.s.0[lane], self.r.0[lane]) = (x, y, s, reach as f32);
        (self.dx.0[lane], self.dy.0[lane], self.ds.0[lane]) = (x1 - x, y1 - y, s1 - s);
    }

    #[inline(always)]
    pub(super) fn way(&self, lane: usize) -> PedestrianWay {
        let [x, y, s, r, dx, dy, ds] =
            [&self.x, &self.y, &self.s, &self.r, &self.dx, &self.dy, &self.ds].map(|lanes| lanes.0[lane]);
        PedestrianWay { x, y, s, r, dx, dy, ds }
    }

    /// The least squared distances of the paths themselves, smaller by what `f32` may be wrong by.
    #[inline(always)]
    pub(super) fn nearest<S: Simd>(&self, simd: S) -> [f32; LANES] {
        let [x, y, dx, dy] = [&self.x, &self.y, &self.dx, &self.dy].map(|lanes| simd.load(&lanes.0));
        let zero = simd.splat(0.0);
        let share = (zero - (x * dx + y * dy)) / (dx * dx + dy * dy + f32::MIN_POSITIVE);
        let share = share.max(zero).min(simd.splat(1.0));
        let (x, y) = (x + share * dx, y + share * dy);
        let mut nearest = [0.0; LANES];
        simd.store((x * x + y * y) * (1.0 - ROUNDING), &mut nearest);
        nearest
    }
}

impl PedestrianWay {
    /// Without moving on.
    #[inline(always)]
    pub(super) fn at_start(self) -> Self {
        Self { dx: 0.0, dy: 0.0, ds: 0.0, ..self }
    }

    /// The deviations that come close, one bit for each. `nearest`: the least squared distance of the path itself.
    #[inline(always)]
    pub(super) fn close<S: Simd>(&self, simd: S, deviations: &DeviationBlocks, nearest: f32) -> u64 {
        let most = self.s + self.ds.max(0.0);
        let mut close = 0;
        // The outermost deviations first: further inside none come close if these stay away.
        for (b, [x, y]) in deviations.blocks.iter().enumerate().rev() {
            let reach = self.r + most * deviations.most[b];
            if nearest > reach * reach {
                break;
            }
            close |= self.close_of_block(simd, x, y) << (b * LANES);
        }
        close
    }

    #[inline(always)]
    fn close_of_block<S: Simd>(&self, simd: S, zx: &Lanes, zy: &Lanes) -> u64 {
        let (zx, zy) = (simd.load(&zx.0), simd.load(&zy.0));
        let (x, y) = (zx * self.s + self.x, zy * self.s + self.y);
        let (dx, dy) = (zx * self.ds + self.dx, zy * self.ds + self.dy);
        // Close where a u^2 + 2 b u + c <= 0 for a share u of the leg.
        let a = dx * dx + dy * dy;
        let b = x * dx + y * dy;
        let c = x * x + y * y - self.r * self.r;
        let on_the_way = b.simd_lt(0.0) & (a + b).simd_gt(0.0) & (a * c).simd_le(b * b);
        let is_close = c.simd_le(0.0) | (a + b + b + c).simd_le(0.0) | on_the_way;
        is_close.to_bitmask()
    }
}
