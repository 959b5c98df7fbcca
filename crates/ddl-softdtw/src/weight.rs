//! Representations of R, the sum of exp(−cost/γ) over paths: a plain number, or a number with a separate exponent.
#![expect(
    clippy::inline_always,
    reason = "the lanes stay in registers only when what works on them is inlined"
)]

use ddl_simd::{Register, wide_exp2_parts};

use crate::lanes::{Lanes, STRIP};

/// Exponent of a cell that no path reaches: far below every other, far from overflow.
const NOTHING: f64 = -1_152_921_504_606_846_976.0; // −2^60
/// Smallest exponent of an addend, relative to the largest. Such an addend does not change the sum, and is a normal
/// number.
const FARTHEST: f64 = -700.0;
/// Bits of 2^−1018. Plain numbers are at least half of it, because products of denormal numbers would take a hundred
/// times as long.
const FLOOR: u64 = (1023 - 1018) << 52;
/// Shares of about this, 2^−142, or less are set to 0.
const NEGLIGIBLE: f64 = f64::from_bits((1023 - 142) << 52);

/// The exponent of the total in shares of [`Plain`] numbers.
pub(crate) const TOTAL: f64 = 145.0;

const ONE: u64 = 1.0_f64.to_bits();
const FRACTION: u64 = u64::MAX >> 12;

/// R of the cells of one antidiagonal of a strip. Both representations round at the same points, so they give the same
/// bits if the plain one suffices.
pub(crate) trait Weight: Copy + 'static {
    /// R of one cell.
    type One: Copy;
    /// 2^−t of each cell.
    type Factor: Copy + 'static;
    /// Fills new room of a record; it is overwritten.
    const NONE_FACTOR: Self::Factor;
    /// Whether t may have any size.
    const UNBOUNDED: bool;
    /// R = 0: no path reaches the cells.
    const NONE: Self;
    /// R = 0, for one cell.
    const NONE_ONE: Self::One;

    /// A power of two.
    fn power(exponent: f64) -> Self::One;

    /// `one` in lane `lane`, no path in the others.
    fn alone(lane: usize, one: Self::One) -> Self;

    /// The lanes moved down by one row, `top` above them.
    fn below<S: Register>(&self, simd: S, top: Self::One) -> Self;

    /// The lanes moved up by one row, `bottom` below them.
    fn above<S: Register>(&self, simd: S, bottom: Self::One) -> Self;

    fn first(&self) -> Self::One;

    fn last(&self) -> Self::One;

    /// 2^`minus_t`; 0 in the lanes that are not `inside`, whose t is 0.
    fn factor<S: Register>(simd: S, minus_t: &Lanes, inside: Option<&[bool; STRIP]>) -> Self::Factor;

    /// The sum over the three predecessors (or successors) of each cell, and `factor` times this sum. The first one is
    /// the diagonal. The other two are added first, so that (y, x) gives the same bits as (x, y).
    fn cells<S: Register>(simd: S, ways: [&Self; 3], factor: &Self::Factor) -> (Self, Self);

    /// The same numbers with every significand in [1, 2).
    fn normalised(self) -> Self;

    fn normalised_one(one: Self::One) -> Self::One;

    /// Significand and exponent.
    fn parts(one: Self::One) -> (f64, f64);

    /// a b / total, 0 if it is negligible. The plain representation requires a total from 2^[`TOTAL`] to twice that.
    fn shares<S: Register>(simd: S, a: &Self, b: &Self, total: (f64, f64)) -> Lanes;
}

/// significand · 2^exponent, with an integer exponent that never leaves its range.
#[derive(Clone, Copy)]
pub(crate) struct Scaled<V> {
    significand: V,
    exponent: V,
}

impl Weight for Scaled<Lanes> {
    type One = Scaled<f64>;
    /// 2^−t as significand · 2^exponent.
    type Factor = Self;
    const NONE_FACTOR: Self = Self::NONE;
    const UNBOUNDED: bool = true;
    const NONE: Self = Self {
        significand: [1.0; STRIP],
        exponent: [NOTHING; STRIP],
    };
    const NONE_ONE: Scaled<f64> = Scaled {
        significand: 1.0,
        exponent: NOTHING,
    };

    fn power(exponent: f64) -> Scaled<f64> {
        Scaled {
            significand: 1.0,
            exponent,
        }
    }

    #[inline(always)]
    fn alone(lane: usize, one: Scaled<f64>) -> Self {
        Self {
            significand: alone(lane, one.significand, 1.0),
            exponent: alone(lane, one.exponent, NOTHING),
        }
    }

    #[inline(always)]
    fn below<S: Register>(&self, simd: S, top: Scaled<f64>) -> Self {
        Self {
            significand: simd.wide_below(&self.significand, top.significand),
            exponent: simd.wide_below(&self.exponent, top.exponent),
        }
    }

    #[inline(always)]
    fn above<S: Register>(&self, simd: S, bottom: Scaled<f64>) -> Self {
        Self {
            significand: simd.wide_above(&self.significand, bottom.significand),
            exponent: simd.wide_above(&self.exponent, bottom.exponent),
        }
    }

    #[inline(always)]
    fn first(&self) -> Scaled<f64> {
        Scaled {
            significand: self.significand[0],
            exponent: self.exponent[0],
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
    fn factor<S: Register>(simd: S, minus_t: &Lanes, inside: Option<&[bool; STRIP]>) -> Self {
        let mut factor = Self::NONE;
        for part in 0..S::PARTS {
            let (significand, exponent) = wide_exp2_parts(simd, simd.wide_load(minus_t, part));
            simd.wide_store(significand, &mut factor.significand, part);
            simd.wide_store(exponent, &mut factor.exponent, part);
        }
        if let Some(inside) = inside {
            for (exponent, inside) in factor.exponent.iter_mut().zip(inside) {
                *exponent = if *inside { *exponent } else { NOTHING };
            }
        }
        factor
    }

    #[inline(always)]
    fn cells<S: Register>(simd: S, ways: [&Self; 3], factor: &Self) -> (Self, Self) {
        let (mut sum, mut cells) = (Self::NONE, Self::NONE);
        let farthest = simd.wide_splat(FARTHEST);
        for part in 0..S::PARTS {
            let mut top = simd.wide_load(&ways[0].exponent, part);
            for way in &ways[1..] {
                top = simd.wide_max(top, simd.wide_load(&way.exponent, part));
            }
            let mut addends = [top; 3];
            for (addend, way) in addends.iter_mut().zip(ways) {
                let shift = simd.wide_sub(simd.wide_load(&way.exponent, part), top);
                let shift = simd.wide_max(shift, farthest);
                *addend = simd.wide_scale(simd.wide_load(&way.significand, part), shift);
            }
            let [diagonal, up, left] = addends;
            let added = simd.wide_add(simd.wide_add(up, left), diagonal);
            simd.wide_store(added, &mut sum.significand, part);
            simd.wide_store(top, &mut sum.exponent, part);
            let significand = simd.wide_load(&factor.significand, part);
            let product = simd.wide_mul(significand, added);
            simd.wide_store(product, &mut cells.significand, part);
            let exponent = simd.wide_load(&factor.exponent, part);
            simd.wide_store(simd.wide_add(top, exponent), &mut cells.exponent, part);
        }
        (sum, cells)
    }

    // Not inlined, because it is rare. By value, because the lanes would not stay in registers behind a reference.
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

    #[inline(always)]
    fn shares<S: Register>(simd: S, a: &Self, b: &Self, (significand, exponent): (f64, f64)) -> Lanes {
        let inverse = simd.wide_splat(1.0 / significand);
        let mut shares = [0.0; STRIP];
        for part in 0..S::PARTS {
            // The significands are from 2^−256 to 2^912: with 2^−2000 a share is negligible.
            let share = simd.wide_mul(simd.wide_load(&a.significand, part), inverse);
            let share = simd.wide_mul(share, simd.wide_load(&b.significand, part));
            let shift = simd.wide_load(&a.exponent, part);
            let shift = simd.wide_add(shift, simd.wide_load(&b.exponent, part));
            let shift = simd.wide_sub(shift, simd.wide_splat(exponent));
            let shift = simd.wide_max(shift, simd.wide_splat(-2000.0));
            let share = simd.wide_scale_far(share, shift);
            let share = simd.wide_zero_unless_above(share, simd.wide_splat(NEGLIGIBLE));
            simd.wide_store(share, &mut shares, part);
        }
        shares
    }
}

/// R itself, times a power of two that lets all of it lie in the range of `f64`.
#[derive(Clone, Copy)]
pub(crate) struct Plain(Lanes);

impl Weight for Plain {
    type One = f64;
    type Factor = Lanes;
    const NONE_FACTOR: Lanes = [0.0; STRIP];
    const UNBOUNDED: bool = false;
    const NONE: Self = Self([0.0; STRIP]);
    const NONE_ONE: f64 = 0.0;

    fn power(exponent: f64) -> f64 {
        f64::from_bits(((exponent as i64 + 1023) as u64) << 52)
    }

    #[inline(always)]
    fn alone(lane: usize, one: f64) -> Self {
        Self(alone(lane, one, 0.0))
    }

    #[inline(always)]
    fn below<S: Register>(&self, simd: S, top: f64) -> Self {
        Self(simd.wide_below(&self.0, top))
    }

    #[inline(always)]
    fn above<S: Register>(&self, simd: S, bottom: f64) -> Self {
        Self(simd.wide_above(&self.0, bottom))
    }

    #[inline(always)]
    fn first(&self) -> f64 {
        self.0[0]
    }

    #[inline(always)]
    fn last(&self) -> f64 {
        self.0[STRIP - 1]
    }

    #[inline(always)]
    fn factor<S: Register>(simd: S, minus_t: &Lanes, inside: Option<&[bool; STRIP]>) -> Lanes {
        let mut factor = [0.0; STRIP];
        for part in 0..S::PARTS {
            let (significand, exponent) = wide_exp2_parts(simd, simd.wide_load(minus_t, part));
            simd.wide_store(simd.wide_scale(significand, exponent), &mut factor, part);
        }
        if let Some(inside) = inside {
            for (factor, inside) in factor.iter_mut().zip(inside) {
                *factor = if *inside { *factor } else { 0.0 };
            }
        }
        factor
    }

    #[inline(always)]
    fn cells<S: Register>(simd: S, [diagonal, up, left]: [&Self; 3], factor: &Lanes) -> (Self, Self) {
        let (mut sum, mut cells) = (Self::NONE, Self::NONE);
        for part in 0..S::PARTS {
            let factor = simd.wide_load(factor, part);
            // FLOOR / factor within a factor of 2. It is added to the diagonal, which is not on the critical path.
            let floor = simd.wide_opposite(factor, FLOOR + ONE);
            let others = simd.wide_add(simd.wide_load(&diagonal.0, part), floor);
            let (up, left) = (simd.wide_load(&up.0, part), simd.wide_load(&left.0, part));
            let added = simd.wide_add(simd.wide_add(up, left), others);
            simd.wide_store(added, &mut sum.0, part);
            simd.wide_store(simd.wide_mul(factor, added), &mut cells.0, part);
        }
        (sum, cells)
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

    #[inline(always)]
    fn shares<S: Register>(simd: S, a: &Self, b: &Self, (significand, _): (f64, f64)) -> Lanes {
        let inverse = simd.wide_splat(Self::power(-TOTAL) / significand);
        let negligible = Self::power(TOTAL).to_bits() - ONE + NEGLIGIBLE.to_bits();
        let mut shares = [0.0; STRIP];
        for part in 0..S::PARTS {
            let (a, b) = (simd.wide_load(&a.0, part), simd.wide_load(&b.0, part));
            // The product would be denormal below 2^−1022 / b: it is not computed below about NEGLIGIBLE 2^TOTAL / b.
            let a = simd.wide_zero_unless_above(a, simd.wide_opposite(b, negligible + ONE));
            let share = simd.wide_mul(simd.wide_mul(a, b), inverse);
            simd.wide_store(share, &mut shares, part);
        }
        shares
    }
}

#[inline(always)]
fn alone(lane: usize, one: f64, none: f64) -> Lanes {
    let mut lanes = [none; STRIP];
    for (l, number) in lanes.iter_mut().enumerate() {
        *number = if l == lane { one } else { none };
    }
    lanes
}

/// A positive normal number as significand in [1, 2) and exponent.
fn split(number: f64) -> (f64, f64) {
    let bits = number.to_bits();
    let significand = f64::from_bits(bits & FRACTION | ONE);
    (significand, (bits >> 52) as f64 - 1023.0)
}
