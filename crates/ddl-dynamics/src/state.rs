//! The state of a rollout, from which a flow determines its velocity.

use nalgebra::SVector;

/// A moment of a rollout: position, time and history of the pedestrian.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct State<'a, T, const D: usize> {
    /// Current position (metres).
    pub position: SVector<T, D>,
    /// Steps taken so far.
    pub step: usize,
    /// Time since the start (seconds).
    pub time: T,
    /// Every position from the start to the current one, oldest first (metres). Empty outside a rollout.
    pub history: &'a [SVector<T, D>],
}

impl<'a, T: crate::Real, const D: usize> State<'a, T, D> {
    /// The state at the start of a rollout, with no history.
    pub fn at(position: SVector<T, D>) -> Self {
        Self {
            position,
            step: 0,
            time: T::zero(),
            history: &[],
        }
    }

    /// The state after `step` steps, at `time` seconds.
    pub fn new(position: SVector<T, D>, step: usize, time: T, history: &'a [SVector<T, D>]) -> Self {
        Self {
            position,
            step,
            time,
            history,
        }
    }
}
