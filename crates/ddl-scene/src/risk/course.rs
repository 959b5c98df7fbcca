//! A plan in legs: everything moves on a straight line during each, with one radius.

#![expect(clippy::inline_always, reason = "kernels are compiled for the instructions of the processor")]

use crate::plan::Plan;
use ddl_core::{HORIZON, Position, TIME_STEP};

/// Rows of a plan nearer than this to a step are at the step (steps).
const SAME: f64 = 1e-9;

/// Part of a step.
#[derive(Debug)]
pub(super) struct CourseLeg {
    /// 0 to 11.
    pub(super) step: usize,
    /// Where it begins and ends, as shares of the step.
    pub(super) shares: [f64; 2],
    /// The plan at its two ends, metres.
    pub(super) positions: [Position; 2],
    pub(super) radius: f64,
}

/// The legs of a plan over 12 steps.
pub(super) fn legs(plan: &Plan) -> Vec<CourseLeg> {
    let mut legs = Vec::with_capacity(HORIZON);
    let mut rows = plan.points().iter().map(|row| row.time / TIME_STEP).peekable();
    let (mut from, mut start) = (0.0, plan.at(0.0).position);
    for step in 0..HORIZON {
        let first = step as f64;
        while from < first + 1.0 {
            let to = rows.next_if(|&row| row < first + 1.0 - SAME).unwrap_or(first + 1.0);
            if to < from + SAME {
                continue;
            }
            let end = plan.at(to * TIME_STEP).position;
            // Rounding may put a row on either side of an end.
            let radius = plan.at(f64::midpoint(from, to) * TIME_STEP).radius;
            legs.push(CourseLeg { step, shares: [from - first, to - first], positions: [start, end], radius });
            (from, start) = (to, end);
        }
    }
    legs
}

/// A pedestrian as the plan sees it during a leg.
#[derive(Debug)]
pub(super) struct LegApproach {
    /// Its path from the plan, at both ends (m).
    pub(super) offsets: [Position; 2],
    /// Scales of its spread there (m).
    pub(super) scales: [f64; 2],
}

impl CourseLeg {
    /// Of a pedestrian with this path and these scales, at the moment and 12 steps after it.
    #[inline]
    pub(super) fn approach(&self, path: &[Position; HORIZON + 1], scales: &[f64; HORIZON + 1]) -> LegApproach {
        let [from, to] = [path[self.step], path[self.step + 1]];
        // `ddl_core::between` is too far away to be inlined here.
        let offset = |end: usize| {
            let along = |axis: usize| from[axis] + self.shares[end] * (to[axis] - from[axis]);
            [along(0) - self.positions[end][0], along(1) - self.positions[end][1]]
        };
        LegApproach { offsets: [offset(0), offset(1)], scales: self.scales(scales) }
    }

    /// The scales at its two ends (m), of these at the moment and 12 steps after it.
    #[inline(always)]
    pub(super) fn scales(&self, scales: &[f64; HORIZON + 1]) -> [f64; 2] {
        let [least, most] = [scales[self.step], scales[self.step + 1]];
        self.shares.map(|share| least + share * (most - least))
    }

    /// The least distance (m) from the edge of the plan during the leg, of the pedestrian that deviates from its path
    /// by `z` scales; below 0 inside.
    pub(super) fn distance(&self, approach: &LegApproach, z: Position) -> f64 {
        let [[x, y], [x1, y1]] =
            [0, 1].map(|end| [0, 1].map(|axis| approach.offsets[end][axis] + approach.scales[end] * z[axis]));
        let [dx, dy] = [x1 - x, y1 - y];
        let nearest = -(x * dx + y * dy) / (dx * dx + dy * dy).max(f64::MIN_POSITIVE);
        let share = nearest.clamp(0.0, 1.0);
        let [x, y] = [x + share * dx, y + share * dy];
        (x * x + y * y).sqrt() - self.radius
    }
}
