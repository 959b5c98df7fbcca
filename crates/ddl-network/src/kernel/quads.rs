//! Four groups of sixteen numbers, and halves of them, in memory and in registers.

use ddl_simd::{DEPTH, Floats, LANES, Lanes, Simd, Vectors};
use fearless_simd::prelude::*;

/// Number of lanes in a half of a group.
pub(super) const HALF: usize = LANES / 2;

/// Four groups of sixteen numbers: four numbers per lane.
pub(super) type Quad = [Lanes; DEPTH];

/// A [`Quad`] of zeros.
pub(super) const ZERO_QUAD: Quad = [Lanes::ZERO; DEPTH];

/// Four times eight numbers: the lower or the upper lanes of a [`Quad`], aligned to a cache line.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
pub(super) struct HalfQuad(pub(super) [[f32; HALF]; DEPTH]);

impl HalfQuad {
    pub(super) const ZERO: Self = Self([[0.0; HALF]; DEPTH]);
}

/// Arithmetic on four groups.
pub(super) trait Quads: Simd {
    /// The vectors of a quad.
    #[inline(always)]
    fn read(self, quad: &Quad) -> Vectors<Self> {
        let [a, b, c, d] = quad;
        [self.load(&a.0), self.load(&b.0), self.load(&c.0), self.load(&d.0)]
    }

    /// Writes the vectors to a quad.
    #[inline(always)]
    fn write(self, vectors: Vectors<Self>, quad: &mut Quad) {
        for d in 0..DEPTH {
            self.store(vectors[d], &mut quad[d].0);
        }
    }

    /// The vectors of a half, in the lower and again in the upper lanes.
    #[inline(always)]
    fn read_twice(self, half: &HalfQuad) -> Vectors<Self> {
        let [a, b, c, d] = &half.0;
        [self.load_halves(a, a), self.load_halves(b, b), self.load_halves(c, c), self.load_halves(d, d)]
    }

    /// Writes the lower and the upper lanes of four vectors.
    #[inline(always)]
    fn write_halves(self, vectors: Vectors<Self>, low: &mut HalfQuad, high: &mut HalfQuad) {
        for (d, vector) in vectors.into_iter().enumerate() {
            self.store_halves(vector, &mut low.0[d], &mut high.0[d]);
        }
    }

    /// Σ a b over four vectors, added to `start`.
    #[inline(always)]
    fn dot(self, a: Vectors<Self>, b: Vectors<Self>, start: Floats<Self>) -> Floats<Self> {
        let mut sum = start;
        for d in 0..DEPTH {
            sum = a[d].mul_add(b[d], sum);
        }
        sum
    }

    /// `sum` + `weight` · `vectors`.
    #[inline(always)]
    fn accumulate(self, mut sum: Vectors<Self>, weight: Floats<Self>, vectors: Vectors<Self>) -> Vectors<Self> {
        for d in 0..DEPTH {
            sum[d] = weight.mul_add(vectors[d], sum[d]);
        }
        sum
    }

    /// `factor` · `vectors`.
    #[inline(always)]
    fn scaled(self, mut vectors: Vectors<Self>, factor: Floats<Self>) -> Vectors<Self> {
        for vector in &mut vectors {
            *vector *= factor;
        }
        vectors
    }
}

impl<S: Simd> Quads for S {}
