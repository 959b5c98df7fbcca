//! How sixteen numbers lie in memory.

/// Numbers that go through an operation together.
pub(crate) const LANES: usize = 16;

/// Numbers of a head that are held in registers together: the width of a head of STAR.
pub(crate) const DEPTH: usize = 4;

/// Sixteen numbers. Aligned, because a register's load that crosses a cache line costs two.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
pub(crate) struct Lanes(pub(crate) [f32; LANES]);

impl Lanes {
    pub(crate) const ZERO: Self = Self([0.0; LANES]);
}

/// Four numbers of each of sixteen heads.
pub(crate) type Block = [Lanes; DEPTH];

pub(crate) const ZEROS: Block = [Lanes::ZERO; DEPTH];
