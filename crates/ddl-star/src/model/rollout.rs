//! From windows and goals to positions on tensors: teacher-forced for training, recurrent for forecasts.

use super::backend::TorchBackend;
use super::batch::SceneBatch;
use super::emission::{Emission, NoiseInput};
use super::flow::{FlowConstants, StepBounds};
use super::goal_frame::GoalFrame;
use super::guidance::Guidance;
use super::network::{Layers, TorchNetwork};
use super::own_motion;
use super::tensor_backend::{Pass, TensorBackend};
use ddl_data::OBSERVED;
use ddl_network::backbone::Backbone;
use ddl_network::backend::{Memory, Mode};
use ddl_network::{NetworkFrame, StepRule};
use std::slice::from_ref;
use tch::{Kind, Tensor};

/// The forecast from observed frames: positions, and the factors that shaped them.
#[derive(Debug)]
#[non_exhaustive]
pub struct Rollout {
    /// `[horizon, H, P, 2]`, metres.
    pub positions: Tensor,
    /// `[horizon, H, P, 3]`: (a, b, c) of L = [[a, 0], [b, c]], in (m/s)^(1/2), of the step to each position; `None`
    /// for the variants without dynamics.
    pub factors: Option<Tensor>,
}

impl TorchNetwork {
    /// One-step-ahead positions: the next position from the true positions up to each frame.
    ///
    /// # Shapes
    /// `batch` of T frames with neighbours of at least T - 1, where T is at least 8 in the pedestrians' own frames and
    /// without goal shift; `goals` `[P, 2]`; `noise` one vector or none -> `[T - 1, P, 2]`, the forecasts of frames
    /// 1..T.
    pub fn teacher_forced(&self, batch: &SceneBatch, goals: &Tensor, noise: &NoiseInput, mode: Mode) -> Tensor {
        let torch = TorchBackend::new(self.parameters(), mode);
        self.layers().teacher_forced(batch, goals, noise, Pass::Torch(&torch))
    }

    /// Forecast positions: 8 observed frames, then every forecast is the input of the next step.
    ///
    /// At all forecast steps the neighbours are those of the last observed frame. H = G hypotheses with one goal each,
    /// or H = number of noise vectors for a single goal (G = 1).
    ///
    /// # Shapes
    /// `batch` of at least 8 frames; `goals` `[G, P, 2]`; `noise` 1 or H vectors, or none -> positions `[horizon, H, P,
    /// 2]` and factors `[horizon, H, P, 3]`.
    pub fn roll_out(
        &self,
        batch: &SceneBatch,
        goals: &Tensor,
        noise: &NoiseInput,
        horizon: usize,
        rule: StepRule,
    ) -> Rollout {
        let torch = TorchBackend::new(self.parameters(), Mode::Evaluate);
        let steps = (horizon, rule);
        self.layers().roll_out(batch, goals, noise, steps, Pass::Torch(&torch))
    }
}

impl Layers {
    /// [`TorchNetwork::teacher_forced`] in a pass.
    pub(crate) fn teacher_forced(
        &self,
        batch: &SceneBatch,
        goals: &Tensor,
        noise: &NoiseInput,
        pass: Pass<'_>,
    ) -> Tensor {
        let emission = Emission::new(pass.output(self.output), noise, &self.config);
        match pass {
            Pass::Torch(backend) => self.teacher_forced_by(batch, goals, &emission, (backend, &*self.on_tensors)),
            Pass::Kernels(pass) => self.teacher_forced_by(batch, goals, &emission, (&pass.backend, &*self.on_rows)),
        }
    }

    fn teacher_forced_by<B: TensorBackend>(
        &self,
        batch: &SceneBatch,
        goals: &Tensor,
        emission: &Emission<'_>,
        (backend, backbone): (&B, &dyn Backbone<B>),
    ) -> Tensor {
        let steps = batch.positions.size()[0] as usize - 1;
        let positions = batch.positions.narrow(0, 0, steps as i64);
        // The frames are known, so the backbone encodes all their scenes at once.
        let centred = backend.given(&centre(batch, &positions));
        let scenes = backbone.scene(backend, &centred, &backend.seen(batch, 0..steps));
        let scenes = backend.each_entry(&scenes);
        let course = self.course(batch, goals, StepRule::Euler);
        let before = Tensor::cat(
            &[positions.narrow(0, 0, 1), positions.narrow(0, 0, steps as i64 - 1)],
            0,
        );
        let relative = backend.each_entry(&backend.given(&course.seen(&positions, &before)));
        let mut memory = Memory::default();
        let features: Vec<B::Tokens> = (0..steps)
            .map(|t| {
                let seen = backend.seen(batch, t..t + 1);
                backbone.step(backend, &mut memory, &relative[t], &scenes[t], &seen)
            })
            .collect();
        let emitted = course.to_world(&emission.of(&backend.joined(&features)));
        course.next_positions(&positions, goals, &emitted, (0, steps))
    }

    /// [`TorchNetwork::roll_out`] in a pass. Gradients flow back through positions and memory only.
    pub(crate) fn roll_out(
        &self,
        batch: &SceneBatch,
        goals: &Tensor,
        noise: &NoiseInput,
        steps: (usize, StepRule),
        pass: Pass<'_>,
    ) -> Rollout {
        let emission = Emission::new(pass.output(self.output), noise, &self.config);
        let emission = (&emission, goals.size()[0].max(noise.count()));
        match pass {
            Pass::Torch(backend) => self.roll_out_by(batch, goals, emission, steps, (backend, &*self.on_tensors)),
            Pass::Kernels(pass) => self.roll_out_by(batch, goals, emission, steps, (&pass.backend, &*self.on_rows)),
        }
    }

    fn roll_out_by<B: TensorBackend>(
        &self,
        batch: &SceneBatch,
        goals: &Tensor,
        (emission, hypotheses): (&Emission<'_>, i64),
        (horizon, rule): (usize, StepRule),
        (backend, backbone): (&B, &dyn Backbone<B>),
    ) -> Rollout {
        let observed = batch.positions.narrow(0, 0, OBSERVED as i64);
        let last = OBSERVED as i64 - 1;
        let course = self.course(batch, goals, rule);
        let centred = backend.given(&centre(batch, &observed));
        let scene = backbone.scene(backend, &centred, &backend.seen(batch, 0..OBSERVED));
        // The observed frames of the hypotheses differ only in the goal that they are relative to, so `relative` has
        // one batch entry for each distinct reference.
        let mut memory = Memory::default();
        let mut features = Vec::new();
        for (t, scene) in backend.each_entry(&scene).iter().enumerate() {
            let at = |t: usize| observed.get(t as i64);
            let relative = backend.given(&course.seen(&at(t), &at(t.saturating_sub(1))));
            let seen = backend.seen(batch, t..t + 1);
            features = vec![backbone.step(backend, &mut memory, &relative, scene, &seen)];
        }
        let mut features = features.remove(0);
        if backend.entries(&features) < hypotheses as usize {
            features = backend.repeated(&features, hypotheses as usize);
            memory = memory.repeated(backend, hypotheses as usize);
        }
        let seen = backend.seen(batch, OBSERVED - 1..OBSERVED);
        let mut position = observed.narrow(0, last, 1).expand([hypotheses, -1, -1], false);
        let mut sum = observed
            .sum_dim_intlist([0i64].as_slice(), true, None::<Kind>)
            .expand([hypotheses, -1, -1], false);
        let mut path = Vec::with_capacity(horizon);
        let mut factors = Vec::with_capacity(horizon);
        for t in OBSERVED..OBSERVED + horizon {
            let joined = backend.joined(from_ref(&features));
            let emitted = course.to_world(&emission.of(&joined));
            let before = position.detach();
            let steps = (t - OBSERVED, OBSERVED + horizon - t);
            position = course.next_positions(&position, goals, &emitted, steps);
            path.push(position.shallow_clone());
            factors.push(emitted);
            if t + 1 < OBSERVED + horizon {
                let position = position.detach();
                sum = &sum + &position;
                let centred = &position - batch.scene_means.of(&sum) / (t + 1) as f64;
                let scene = backbone.scene(backend, &backend.given(&centred), &seen);
                let relative = backend.given(&course.seen(&position, &before));
                features = backbone.step(backend, &mut memory, &relative, &scene, &seen);
            }
        }
        let shaped = self.config.variant.dynamics();
        Rollout {
            positions: Tensor::stack(&path, 0),
            factors: shaped.then(|| Tensor::stack(&factors, 0)),
        }
    }

    /// Goals and frames of the pedestrians for this network. Shapes: `batch` of at least 8 frames, unless the network
    /// reads positions relative to the goal in the world's frame; `goals` `[.., P, 2]`.
    fn course(&self, batch: &SceneBatch, goals: &Tensor, rule: StepRule) -> Guidance {
        let config = &self.config;
        let time_step = config.time_step;
        let observed = || batch.positions.narrow(0, 0, OBSERVED as i64);
        let last = || batch.positions.narrow(0, OBSERVED as i64 - 1, 1);
        let goals = if goals.dim() == 2 {
            goals.unsqueeze(0)
        } else {
            goals.shallow_clone()
        };
        let frame = match config.frame {
            NetworkFrame::World => None,
            NetworkFrame::Goal => Some(GoalFrame::new(&observed(), &goals, time_step)),
        };
        Guidance {
            reference: if config.variant.goal_shift() { goals } else { last() },
            frame,
            dynamics: config.variant.dynamics(),
            constants: FlowConstants {
                sigma: config.sigma,
                time_step,
            },
            bounds: match rule {
                StepRule::Euler => None,
                StepRule::Bounded => Some(StepBounds {
                    top_speed: own_motion::top_speeds(&observed(), time_step),
                    velocity: own_motion::velocities(&observed(), time_step),
                    share: batch.share.shallow_clone(),
                    absolute: config.frame == NetworkFrame::World,
                }),
            },
        }
    }
}

/// Positions relative to the mean over all pedestrians of the scene and all frames so far.
/// Shapes: `positions` `[T, P, 2]` -> the same.
fn centre(batch: &SceneBatch, positions: &Tensor) -> Tensor {
    let frames = positions.size()[0];
    let count = Tensor::arange_start(1, frames + 1, (positions.kind(), positions.device())).view([frames, 1, 1]);
    positions - batch.scene_means.of(&(positions.cumsum(0, positions.kind()) / count))
}
