//! Columns of the recursion: one number for every row of a block.

#![expect(clippy::inline_always, reason = "the lanes must stay in registers")]

use crate::sliding::accuracy::COST_CEILING;
use ddl_simd::{Lanes, Register};

pub(super) type Column<S, const M: usize> = [<S as Register>::Floats; M];

#[derive(Clone, Copy)]
pub(super) struct Setting<S: Register> {
    pub(super) simd: S,
    pub(super) rows: usize,
    pub(super) part: usize,
    pub(super) zero: S::Floats,
    pub(super) floor: S::Floats,
    pub(super) front: S::Floats,
    pub(super) back: S::Floats,
}

/// K of the steps of `block` and all `samples`, a column for each of the samples.
#[inline(always)]
pub(super) fn similarities<S: Register, const D: usize, const M: usize>(
    setting: Setting<S>,
    samples: &[[Lanes; D]],
    block: &[[f32; D]],
    into: &mut [Column<S, M>],
) {
    let simd = setting.simd;
    let lowest = simd.splat(-COST_CEILING);
    for (sample, column) in samples.iter().zip(into) {
        for (step, k) in block.iter().zip(column) {
            let mut exponent = setting.zero;
            for d in 0..D {
                let other = simd.load(&sample[d].0, setting.part);
                let difference = simd.sub(simd.splat(step[d]), other);
                exponent = simd.neg_mul_add(difference, difference, exponent);
            }
            *k = simd.exp2(simd.max(exponent, lowest));
        }
    }
}

/// Computes the next column of a recursion. `state` holds the previous column, and `edge` is the predecessor of the
/// first row. Row r of the recursion is row r of `k`; with `UPWARDS` it is the r-th of its last `rows`, counted from
/// the end.
#[inline(always)]
fn advance<S: Register, const M: usize, const UPWARDS: bool>(
    setting: Setting<S>,
    rows: usize,
    k: &Column<S, M>,
    state: &mut Column<S, M>,
    edge: S::Floats,
) {
    let (simd, floor) = (setting.simd, setting.floor);
    if rows == 0 {
        return;
    }
    let row = |r: usize| if UPWARDS { rows - 1 - r } else { r };
    let mut diagonal = state[0];
    let mut up = simd.mul_add(k[row(0)], simd.add(diagonal, edge), floor);
    state[0] = up;
    for r in 1..rows {
        let (k, left) = (k[row(r)], state[r]);
        // `up` is the result of the previous cell and available last, so it is added last.
        let others = simd.mul_add(k, simd.add(left, diagonal), floor);
        up = simd.mul_add(k, up, others);
        state[r] = up;
        diagonal = left;
    }
}

/// The next column of F(j): first cells in column j − l.
#[inline(always)]
pub(super) fn advance_front<S: Register, const M: usize>(
    setting: Setting<S>,
    k: &Column<S, M>,
    l: usize,
    front: &mut Column<S, M>,
) {
    let edge = if l == 0 { setting.front } else { setting.zero };
    advance::<S, M, true>(setting, setting.rows, k, front, edge);
}

/// The next column of B(j): last cells in column j + q.
#[inline(always)]
pub(super) fn advance_back<S: Register, const M: usize>(
    setting: Setting<S>,
    k: &Column<S, M>,
    q: usize,
    back: &mut Column<S, M>,
    backs: &mut [Column<S, M>; M],
) {
    // A path leaves row c straight down from m, or diagonally.
    let edge = if q < 2 { setting.back } else { setting.zero };
    advance::<S, M, false>(setting, setting.rows - 1, k, back, edge);
    backs[q] = *back;
}
