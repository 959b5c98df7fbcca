//! Memory layout of numbers, in groups of sixteen.

/// Number of `f32` values in a group.
pub const LANES: usize = 16;

/// Number of lanes in a half of a group.
pub const HALF: usize = LANES / 2;

/// Number of vectors in a [`Quad`].
pub const DEPTH: usize = 4;

/// Sixteen numbers, aligned, because a load across a cache line costs two.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
pub struct Lanes(pub [f32; LANES]);

impl Lanes {
    /// Sixteen zeros.
    pub const ZERO: Self = Self([0.0; LANES]);
}

/// Four groups of sixteen numbers: four numbers per lane.
pub type Quad = [Lanes; DEPTH];

/// A [`Quad`] of zeros.
pub const ZERO_QUAD: Quad = [Lanes::ZERO; DEPTH];

/// Four times eight numbers: the lower or the upper lanes of a [`Quad`], aligned to a cache line.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
pub struct HalfQuad(pub [[f32; HALF]; DEPTH]);

impl HalfQuad {
    /// Zeros.
    pub const ZERO: Self = Self([[0.0; HALF]; DEPTH]);
}
