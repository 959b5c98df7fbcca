//! Where the walkers of a batch are led, and what the network's input and output mean on the way.

use crate::flow::{FlowConstants, natural_gradient_step};
use crate::goal_frame::GoalFrame;
use tch::Tensor;

/// What the walkers of a batch are told of where they go, and what their output means there.
#[derive(Debug)]
pub(super) struct Course {
    /// What temporal positions are relative to, `[G or 1, P, 2]`: the goal, or the last observed position.
    pub(super) reference: Tensor,
    /// The frame they are read in; `None` for that of the world.
    pub(super) frame: Option<GoalFrame>,
    pub(super) dynamics: bool,
    /// Seconds.
    pub(super) time_step: f64,
}

impl Course {
    /// Positions as the temporal encoder reads them, with the velocity since the positions `before` where there is a frame.
    ///
    /// # Shapes
    /// `[.., P, 2]` -> `[.., P, inputs]`, broadcast with the reference.
    pub(super) fn seen(&self, positions: &Tensor, before: &Tensor) -> Tensor {
        let relative = positions - &self.reference;
        match &self.frame {
            None => relative,
            Some(frame) => {
                let velocity = frame.of_world(&((positions - before) / self.time_step));
                let place = frame.of_world(&relative);
                Tensor::cat(
                    &[place.expand_as(&velocity), velocity.expand_as(&place)],
                    -1,
                )
            }
        }
    }

    /// What the output layer says, in the frame of the world.
    pub(super) fn to_world(&self, emitted: &Tensor) -> Tensor {
        match &self.frame {
            None => emitted.shallow_clone(),
            Some(frame) if self.dynamics => frame.factors_to_world(emitted),
            Some(frame) => frame.to_world(emitted),
        }
    }

    pub(super) fn next_positions(
        &self,
        positions: &Tensor,
        goals: &Tensor,
        emitted: &Tensor,
        constants: FlowConstants,
    ) -> Tensor {
        if self.dynamics {
            natural_gradient_step(positions, goals, emitted, constants)
        } else {
            &self.reference + emitted
        }
    }
}
