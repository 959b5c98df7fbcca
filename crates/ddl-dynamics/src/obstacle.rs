//! Obstacles: balls that stand still or move.

use nalgebra::SVector;

use crate::{
    error::{DynamicsError, ensure_finite, ensure_positive},
    polar::polar_way,
    real::Real,
    state::State,
};

/// A ball that no pedestrian enters: a pillar, or the disc of another pedestrian.
///
/// # Shapes
/// Centre with `D` components and radius, in metres.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ball<T, const D: usize> {
    centre: SVector<T, D>,
    radius: T,
}

impl<T: Real, const D: usize> Ball<T, D> {
    /// The ball around `centre` with `radius` (metres).
    ///
    /// # Errors
    /// [`DynamicsError::NonFinite`] for the centre, [`DynamicsError::NotPositive`] unless the radius is positive and
    /// finite.
    pub fn new(centre: SVector<T, D>, radius: T) -> Result<Self, DynamicsError> {
        ensure_finite("centre of the obstacle", &centre)?;
        let radius = ensure_positive("the radius of the obstacle", " m", radius)?;
        Ok(Self { centre, radius })
    }

    /// The centre (metres).
    pub fn centre(&self) -> &SVector<T, D> {
        &self.centre
    }

    /// The distance from the surface (metres), negative inside, and the unit vector from the centre to `position`, 0 at
    /// the centre. A distance too large for `T` is infinite.
    #[must_use]
    pub fn gap_and_normal(&self, position: &SVector<T, D>) -> (T, SVector<T, D>) {
        let (distance, normal) = polar_way(&self.centre, position);
        (distance - self.radius, normal)
    }
}

/// A source of the obstacles at a state.
///
/// Implemented by arrays and vectors of balls (constant in time) and by [`ObstacleSchedule`].
pub trait ObstacleSource<T: Real, const D: usize> {
    /// The obstacles at `state`.
    fn obstacles(&self, state: &State<T, D>) -> &[Ball<T, D>];
}

impl<T: Real, const D: usize, O: AsRef<[Ball<T, D>]>> ObstacleSource<T, D> for O {
    fn obstacles(&self, _state: &State<T, D>) -> &[Ball<T, D>] {
        self.as_ref()
    }
}

/// Moving obstacles: a set per step; the last one holds for all later steps.
///
/// Give each step the obstacles as they will be at its *end*; see
/// [`AvoidingFlow`](crate::AvoidingFlow#obstacles-that-move).
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ObstacleSchedule<T, const D: usize> {
    steps: Vec<Vec<Ball<T, D>>>,
}

impl<T: Real, const D: usize> ObstacleSchedule<T, D> {
    /// The schedule with `steps[k]` in step `k`; empty for no obstacles.
    pub fn new(steps: Vec<Vec<Ball<T, D>>>) -> Self {
        Self { steps }
    }
    fn in_step(&self, step: usize) -> &[Ball<T, D>] {
        let of_step = self.steps.get(step).or(self.steps.last());
        of_step.map_or(&[], Vec::as_slice)
    }
}

impl<T: Real, const D: usize> ObstacleSource<T, D> for ObstacleSchedule<T, D> {
    fn obstacles(&self, state: &State<T, D>) -> &[Ball<T, D>] {
        self.in_step(state.step)
    }
}

impl<T: Real, const D: usize> ObstacleSource<T, D> for &ObstacleSchedule<T, D> {
    fn obstacles(&self, state: &State<T, D>) -> &[Ball<T, D>] {
        self.in_step(state.step)
    }
}
