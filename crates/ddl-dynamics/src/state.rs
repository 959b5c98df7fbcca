//! The state of a rollout, from which a flow determines its velocity.

use nalgebra::SVector;

/// A moment of a rollout: position and time of the pedestrian.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct State<T, const D: usize> {
    /// Current position (metres).
    pub position: SVector<T, D>,
    /// Steps taken so far.
    pub step: usize,
    /// Time since the start (seconds).
    pub time: T,
}

impl<T: crate::Real, const D: usize> State<T, D> {
    /// The state after `step` steps, at `time` seconds.
    pub fn new(position: SVector<T, D>, step: usize, time: T) -> Self {
        Self { position, step, time }
    }
}
