//! Rotation of the ground plane, the augmentation that STAR and DDL train with.

use std::f64::consts::PI;

use ddl_core::Position;
use rand::{Rng, RngExt};

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

    /// A rotation by an angle drawn uniformly from [0, pi).
    #[must_use]
    pub fn random(rng: &mut impl Rng) -> Self {
        Self::new(rng.random_range(0.0..PI))
    }

    /// The rotated position (m).
    #[must_use]
    pub fn apply(&self, [x, y]: Position) -> Position {
        [self.cosine * x - self.sine * y, self.sine * x + self.cosine * y]
    }
}
