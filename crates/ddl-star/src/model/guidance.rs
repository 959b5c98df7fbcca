//! Goals of the pedestrians of a batch, and the frame of the network's input and output.

use crate::model::flow::{FlowConstants, StepBounds, bounded_step, natural_gradient_step};
use crate::model::goal_frame::GoalFrame;
use ddl_dynamics::StepTime;
use tch::Tensor;

#[derive(Debug)]
pub(super) struct Guidance {
    /// The reference of temporal positions, `[G or 1, P, 2]`: the goal, or the last observed position.
    pub(super) reference: Tensor,
    /// The frame of temporal positions; `None` for that of the world.
    pub(super) frame: Option<GoalFrame>,
    pub(super) dynamics: bool,
    pub(super) constants: FlowConstants,
    /// Bounds of the steps; `None` for plain Euler steps.
    pub(super) bounds: Option<StepBounds>,
}

impl Guidance {
    /// The input of the temporal encoder: positions and, in a pedestrian's own frame, the velocity since the positions
    /// `before`.
    /// Shapes: `[.., P, 2]` -> `[.., P, inputs]`, broadcast with the reference.
    pub(super) fn seen(&self, positions: &Tensor, before: &Tensor) -> Tensor {
        let relative = positions - &self.reference;
        match &self.frame {
            None => relative,
            Some(frame) => {
                let velocity = frame.of_world(&((positions - before) / self.constants.time_step));
                let place = frame.of_world(&relative);
                Tensor::cat(&[place.expand_as(&velocity), velocity.expand_as(&place)], -1)
            }
        }
    }

    /// The output of the output layer, in the frame of the world.
    pub(super) fn to_world(&self, emitted: &Tensor) -> Tensor {
        match &self.frame {
            None => emitted.shallow_clone(),
            Some(frame) if self.dynamics => frame.factors_to_world(emitted),
            Some(frame) => frame.to_world(emitted),
        }
    }

    /// Next positions after one step: `done` steps are made and `left` remain, including this one.
    pub(super) fn next_positions(
        &self,
        positions: &Tensor,
        goals: &Tensor,
        emitted: &Tensor,
        (done, left): (usize, usize),
    ) -> Tensor {
        if !self.dynamics {
            return &self.reference + emitted;
        }
        let constants = self.constants;
        match &self.bounds {
            None => natural_gradient_step(positions, goals, emitted, constants),
            Some(bounds) => {
                let dt = constants.time_step;
                let time = StepTime { done, left, dt };
                bounded_step(positions, goals, emitted, constants, bounds, time)
            }
        }
    }
}
