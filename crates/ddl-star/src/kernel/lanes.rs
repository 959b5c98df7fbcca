//! How the numbers of heads lie in memory, sixteen at a time.

/// Numbers that go through an operation together.
pub(super) const LANES: usize = 16;

/// Numbers of a head in a [`Quad`], held in registers together: the width of a head of STAR.
pub(super) const DEPTH: usize = 4;

/// Sixteen numbers. Aligned, because a register's load that crosses a cache line costs two.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
pub(super) struct Lanes(pub(super) [f32; LANES]);

impl Lanes {
    pub(super) const ZERO: Self = Self([0.0; LANES]);
}

/// Four numbers of each of sixteen heads.
pub(super) type Quad = [Lanes; DEPTH];

pub(super) const ZERO_QUAD: Quad = [Lanes::ZERO; DEPTH];
