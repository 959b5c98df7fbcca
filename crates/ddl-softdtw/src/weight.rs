//! How the recursion holds R, the sum of exp(−cost/γ) over paths: as a plain number, or with an exponent of its own.
#![expect(
    clippy::inline_always,
    reason = "the lanes stay in registers only when what works on them is inlined"
)]

use crate::exp2::{Lanes, ROUNDING, STRIP, below, exp2_minus};

/// Exponent of a cell that no path reaches: far below every other, far from overflow.
const NOTHING: f64 = -1_152_921_504_606_846_976.0; // −2^60
/// An addend 2^700 below the largest counts as that far below: it does not change the sum, and stays a normal number.
const FARTHEST: f64 = -700.0;

/// The three ways into each cell, from (i−1, j−1), (i−1, j) and (i, j−1), by one scale a cell, and their sums.
pub(crate) type Addends = ([Lanes; 3], Lanes);

/// R of the cells of one antidiagonal of a strip. Both kinds round in the same places, so they give the same bits
/// wherever the plain one suffices.
pub(crate) trait Weight: Copy {
    /// R of one cell.
    type One: Copy;
    /// No path.
    const NONE: Self;
    /// No path, for one cell.
    const NONE_ONE: Self::One;

    /// One in lane `lane`, none in the others: the point every path starts from.
    fn origin(lane: usize) -> Self;

    /// The lanes moved down by one row, `top` above them.
    fn below(&self, top: Self::One) -> Self;

    fn last(&self) -> Self::One;

    /// 2^−t times the sum of the three ways into each cell.
    fn cells(diagonal: &Self, up: &Self, left: &Self, t: &Lanes) -> (Self, Addends);

    /// None in the lanes that are not `inside`.
    fn within(self, inside: [bool; STRIP]) -> Self;

    /// The same numbers with every significand in [1, 2).
    fn normalised(self) -> Self;

    fn normalised_one(one: Self::One) -> Self::One;

    fn parts(one: Self::One) -> (f64, f64);
}

/// significand · 2^exponent, with an integer exponent that never leaves its range.
#[derive(Clone, Copy)]
pub(crate) struct Scaled<V> {
    significand: V,
    exponent: V,
}

impl Weight for Scaled<Lanes> {
    type One = Scaled<f64>;
    const NONE: Self = Self {
        significand: [1.0; STRIP],
        exponent: [NOTHING; STRIP],
    };
    const NONE_ONE: Scaled<f64> = Scaled {
        significand: 1.0,
        exponent: NOTHING,
    };

    #[inline(always)]
    fn origin(lane: usize) -> Self {
        let mut origin = Self::NONE;
        for (l, exponent) in origin.exponent.iter_mut().enumerate() {
            *exponent = if l == lane { 0.0 } else { NOTHING };
        }
        origin
    }

    #[inline(always)]
    fn below(&self, top: Scaled<f64>) -> Self {
        Self {
            significand: below(&self.significand, top.significand),
            exponent: below(&self.exponent, top.exponent),
        }
    }

    #[inline(always)]
    fn last(&self) -> Scaled<f64> {
        Scaled {
            significand: self.significand[STRIP - 1],
            exponent: self.exponent[STRIP - 1],
        }
    }

    #[inline(always)]
    fn cells(diagonal: &Self, up: &Self, left: &Self, t: &Lanes) -> (Self, Addends) {
        let mut top = [0.0; STRIP];
        for (l, top) in top.iter_mut().enumerate() {
            let (a, b, c) = (diagonal.exponent[l], up.exponent[l], left.exponent[l]);
            let bc = if b > c { b } else { c };
            *top = if a > bc { a } else { bc };
        }
        let mut addends = [[0.0; STRIP]; 3];
        for (addend, way) in addends.iter_mut().zip([diagonal, up, left]) {
            for l in 0..STRIP {
                let shift = way.exponent[l] - top[l];
                let shift = if shift > FARTHEST { shift } else { FARTHEST };
                // The low bits of the sum are the shift; moved to the place of the exponent they multiply by 2^shift.
                let shift = (shift + ROUNDING).to_bits() << 52;
                addend[l] = f64::from_bits(way.significand[l].to_bits().wrapping_add(shift));
            }
        }
        let (whole, power) = exp2_minus(t);
        let mut sums = [0.0; STRIP];
        let mut cells = *left;
        for l in 0..STRIP {
            sums[l] = sum(&addends, l);
            cells.significand[l] = power[l] * sums[l];
            cells.exponent[l] = top[l] - whole[l];
        }
        (cells, (addends, sums))
    }

    #[inline(always)]
    fn within(mut self, inside: [bool; STRIP]) -> Self {
        for (exponent, inside) in self.exponent.iter_mut().zip(inside) {
            *exponent = if inside { *exponent } else { NOTHING };
        }
        self
    }

    // Not inlined, and by value: it is rare, and behind a reference the lanes would not stay in registers.
    #[inline(never)]
    fn normalised(mut self) -> Self {
        for l in 0..STRIP {
            let one = Self::normalised_one(Scaled {
                significand: self.significand[l],
                exponent: self.exponent[l],
            });
            self.significand[l] = one.significand;
            self.exponent[l] = one.exponent;
        }
        self
    }

    fn normalised_one(one: Scaled<f64>) -> Scaled<f64> {
        let (significand, exponent) = split(one.significand);
        Scaled {
            significand,
            exponent: one.exponent + exponent,
        }
    }

    fn parts(one: Scaled<f64>) -> (f64, f64) {
        let one = Self::normalised_one(one);
        (one.significand, one.exponent)
    }
}

/// R itself, for sequences so short and costs so small that all of it lies in the range of `f64`.
#[derive(Clone, Copy)]
pub(crate) struct Plain(Lanes);

impl Weight for Plain {
    type One = f64;
    const NONE: Self = Self([0.0; STRIP]);
    const NONE_ONE: f64 = 0.0;

    #[inline(always)]
    fn origin(lane: usize) -> Self {
        let mut origin = Self::NONE;
        for (l, one) in origin.0.iter_mut().enumerate() {
            *one = if l == lane { 1.0 } else { 0.0 };
        }
        origin
    }

    #[inline(always)]
    fn below(&self, top: f64) -> Self {
        Self(below(&self.0, top))
    }

    #[inline(always)]
    fn last(&self) -> f64 {
        self.0[STRIP - 1]
    }

    #[inline(always)]
    fn cells(diagonal: &Self, up: &Self, left: &Self, t: &Lanes) -> (Self, Addends) {
        let addends = [diagonal.0, up.0, left.0];
        let (whole, power) = exp2_minus(t);
        let mut sums = [0.0; STRIP];
        let mut cells = [0.0; STRIP];
        for l in 0..STRIP {
            sums[l] = sum(&addends, l);
            let shift = (ROUNDING - whole[l]).to_bits() << 52;
            cells[l] = f64::from_bits(power[l].to_bits().wrapping_add(shift)) * sums[l];
        }
        (Self(cells), (addends, sums))
    }

    #[inline(always)]
    fn within(mut self, inside: [bool; STRIP]) -> Self {
        for (one, inside) in self.0.iter_mut().zip(inside) {
            *one = if inside { *one } else { 0.0 };
        }
        self
    }

    #[inline(always)]
    fn normalised(self) -> Self {
        self
    }

    fn normalised_one(one: f64) -> f64 {
        one
    }

    fn parts(one: f64) -> (f64, f64) {
        split(one)
    }
}

/// The sum of the three ways into lane `l`. The upper and the left one first: so (y, x) gives the same bits as (x, y).
#[inline(always)]
fn sum(addends: &[Lanes; 3], l: usize) -> f64 {
    (addends[1][l] + addends[2][l]) + addends[0][l]
}

/// A positive normal number as significand in [1, 2) and exponent.
fn split(number: f64) -> (f64, f64) {
    let bits = number.to_bits();
    let significand = f64::from_bits((bits & (u64::MAX >> 12)) | 1.0_f64.to_bits());
    (significand, (bits >> 52) as f64 - 1023.0)
}
