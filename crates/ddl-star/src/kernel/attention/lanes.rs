//! Sixteen numbers at a time.
//!
//! Plain loops over short arrays. Inlined into a function that is compiled for more instructions, they become one
//! instruction of 512 bits, two of 256 or four of 128: the layout of the data is the same on every machine.

#![expect(clippy::inline_always, reason = "the lanes must stay in registers")]
#![expect(
    clippy::needless_range_loop,
    reason = "iterators over arrays by value go through memory"
)]

/// Numbers in a group.
pub(crate) const LANES: usize = 16;

/// Sixteen numbers, where a register that holds all of them can be loaded at once.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
pub(crate) struct Lanes(pub(crate) [f32; LANES]);

/// Sixteen vectors of four numbers.
pub(crate) type Vectors = [Lanes; DEPTH];

/// Numbers of a vector that are held in registers together: the width of a head of STAR.
pub(crate) const DEPTH: usize = 4;

impl Lanes {
    pub(crate) const ZERO: Self = Self::splat(0.0);

    #[inline(always)]
    pub(crate) const fn splat(value: f32) -> Self {
        Self([value; LANES])
    }

    #[inline(always)]
    pub(crate) fn add(self, other: Self) -> Self {
        self.zip(other, |a, b| a + b)
    }

    #[inline(always)]
    pub(crate) fn sub(self, other: Self) -> Self {
        self.zip(other, |a, b| a - b)
    }

    #[inline(always)]
    pub(crate) fn mul(self, other: Self) -> Self {
        self.zip(other, |a, b| a * b)
    }

    /// The larger of each two numbers; that of `other` where one is NaN.
    #[inline(always)]
    pub(crate) fn max(self, other: Self) -> Self {
        self.zip(other, |a, b| if a > b { a } else { b })
    }

    #[inline(always)]
    pub(crate) fn reciprocal(self) -> Self {
        Self::splat(1.0).zip(self, |a, b| a / b)
    }

    /// self b + c, rounded once with a fused multiplication, else twice.
    #[inline(always)]
    pub(crate) fn mul_add<const FUSED: bool>(self, b: Self, c: Self) -> Self {
        let mut result = [0.0; LANES];
        for lane in 0..LANES {
            // Without the instruction, `f32::mul_add` is a slow call.
            result[lane] = if FUSED {
                self.0[lane].mul_add(b.0[lane], c.0[lane])
            } else {
                self.0[lane] * b.0[lane] + c.0[lane]
            };
        }
        Self(result)
    }

    #[inline(always)]
    pub(crate) fn zip(self, other: Self, f: impl Fn(f32, f32) -> f32) -> Self {
        let mut result = [0.0; LANES];
        for lane in 0..LANES {
            result[lane] = f(self.0[lane], other.0[lane]);
        }
        Self(result)
    }
}

/// Every vector of each lane times the lane's `factor`.
#[inline(always)]
pub(crate) fn scaled(vectors: &Vectors, factor: Lanes) -> Vectors {
    let mut result = [Lanes::ZERO; DEPTH];
    for d in 0..DEPTH {
        result[d] = vectors[d].mul(factor);
    }
    result
}

/// `start` + Σ a b over the vectors of each lane.
#[inline(always)]
pub(crate) fn dot<const FUSED: bool>(a: &[Vectors], b: &[Vectors], start: Lanes) -> Lanes {
    let mut sum = start;
    for (a, b) in a.iter().zip(b) {
        for d in 0..DEPTH {
            sum = a[d].mul_add::<FUSED>(b[d], sum);
        }
    }
    sum
}

/// `sum` + `weight` · `vectors`.
#[inline(always)]
pub(crate) fn accumulate<const FUSED: bool>(sum: &mut Vectors, weight: Lanes, vectors: &Vectors) {
    for d in 0..DEPTH {
        sum[d] = weight.mul_add::<FUSED>(vectors[d], sum[d]);
    }
}
