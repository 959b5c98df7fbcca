//! A pedestrian's own frame: the first axis points from its last observed position to its goal; lengths are in its own
//! [unit](ddl_network::length_unit).

use crate::model::own_motion;
use ddl_core::OBSERVED;
use tch::Tensor;

/// Closer to its goal than this (metres), a pedestrian uses the axes of the world.
const SMALLEST_DISTANCE: f64 = 1e-6;
/// Lower bound of the squares of pivots, in m/s.
pub(super) const SMALLEST_PIVOT: f64 = 1e-12;

/// The first axis of every pedestrian in every hypothesis, as cosine and sine, and its unit. Shapes: `[G, P, 1]`; the
/// unit `[1, P, 1]` is a dimensionless factor (metres in a unit).
#[derive(Debug)]
pub(crate) struct GoalFrame {
    cos: Tensor,
    sin: Tensor,
    unit: Tensor,
}

impl GoalFrame {
    /// Shapes: `observed` `[8, P, 2]`; `goals` `[G, P, 2]`; `time_step` in seconds.
    pub(crate) fn new(observed: &Tensor, goals: &Tensor, time_step: f64) -> Self {
        let towards = goals - observed.narrow(0, OBSERVED as i64 - 1, 1);
        let distance = towards.norm_scalaropt_dim(2, [-1i64].as_slice(), true);
        let near = distance.lt(SMALLEST_DISTANCE);
        let along = |axis: i64, near_goal: f64| (towards.narrow(-1, axis, 1) / &distance).masked_fill(&near, near_goal);
        Self { cos: along(0, 1.0), sin: along(1, 0.0), unit: own_motion::units(observed, time_step) }
    }

    /// Vectors of the world in the axes and units of the pedestrians.
    /// Shapes: `[.., P, 2]`, broadcast with `[G, P, 1]`.
    pub(crate) fn of_world(&self, vectors: &Tensor) -> Tensor {
        let (x, y) = (vectors.narrow(-1, 0, 1), vectors.narrow(-1, 1, 1));
        let ahead = &self.cos * &x + &self.sin * &y;
        let left = &self.cos * &y - &self.sin * &x;
        Tensor::cat(&[ahead, left], -1) / &self.unit
    }

    /// The inverse of [`of_world`](Self::of_world).
    pub(crate) fn to_world(&self, vectors: &Tensor) -> Tensor {
        let (x, y) = (vectors.narrow(-1, 0, 1), vectors.narrow(-1, 1, 1));
        let along_x = &self.cos * &x - &self.sin * &y;
        let along_y = &self.cos * &y + &self.sin * &x;
        Tensor::cat(&[along_x, along_y], -1) * &self.unit
    }

    /// The lower-triangular factor of the same metric in the world: L' L'^T = R^T L L^T R. Shapes: `factors` `[.., P,
    /// 3]` holds (a, b, c) of L = [[a, 0], [b, c]]; the result holds those of L'.
    ///
    /// # Numerics
    /// The first row of R^T L is zero if L is singular with its null space along the x axis of the world. Then the
    /// square of the first pivot is raised to 1e-12 m/s, and the second row is lost: the pedestrian stands, and P is
    /// still positive definite.
    pub(crate) fn factors_to_world(&self, factors: &Tensor) -> Tensor {
        let l = |i: i64| factors.narrow(-1, i, 1);
        let (a, b, c) = (l(0), l(1), l(2));
        let (x1, x2) = (&self.cos * &a - &self.sin * &b, -(&self.sin * &c));
        let (y1, y2) = (&self.sin * &a + &self.cos * &b, &self.cos * &c);
        let first = (x1.square() + x2.square()).clamp_min(SMALLEST_PIVOT).sqrt();
        let below = (x1 * y1 + x2 * y2) / &first;
        let rest = &a * &c / &first;
        Tensor::cat(&[first, below, rest], -1)
    }
}
