//! Memory layout of numbers, in groups of sixteen.

/// Number of `f32` values in a group.
pub const LANES: usize = 16;

/// Number of lanes in a group of lanes, and of vectors that exchange their lanes.
pub const DEPTH: usize = 4;

/// Sixteen numbers, aligned, because a load across a cache line costs two.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
pub struct Lanes(pub [f32; LANES]);

impl Lanes {
    /// Sixteen zeros.
    pub const ZERO: Self = Self([0.0; LANES]);
}
