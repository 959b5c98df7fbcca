//! How numbers lie in memory, sixteen at a time.

/// Numbers of `f32` that go through an operation together.
pub const LANES: usize = 16;

/// Numbers of `f64` that take the place of [`LANES`] numbers of `f32`.
pub const WIDE_LANES: usize = LANES / 2;

/// Vectors in a [`Quad`].
pub const DEPTH: usize = 4;

/// Sixteen numbers. Aligned, because a register's load that crosses a cache line costs two.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
pub struct Lanes(pub [f32; LANES]);

impl Lanes {
    /// Sixteen zeros.
    pub const ZERO: Self = Self([0.0; LANES]);
}

/// Four times sixteen numbers: four numbers of each lane.
pub type Quad = [Lanes; DEPTH];

/// A [`Quad`] of zeros.
pub const ZERO_QUAD: Quad = [Lanes::ZERO; DEPTH];
