//! Rotation of the ground plane, the augmentation that STAR and DDL train with.

use crate::position::Position;

/// A rotation about the world's origin.
///
/// Training draws one angle in [0, pi) for each batch.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rotation {
    sine: f64,
    cosine: f64,
}

impl Rotation {
    /// Counter-clockwise by an angle (rad).
    #[must_use]
    pub fn new(angle_rad: f64) -> Self {
        let (sine, cosine) = angle_rad.sin_cos();
        Self { sine, cosine }
    }

    /// The rotated position (m).
    #[must_use]
    pub fn apply(&self, [x, y]: Position) -> Position {
        [self.cosine * x - self.sine * y, self.sine * x + self.cosine * y]
    }
}
