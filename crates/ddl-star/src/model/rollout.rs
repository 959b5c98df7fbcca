//! From windows and goals to positions on tensors: teacher-forced for training, recurrent for forecasts.

use crate::model::batch::WindowBatch;
use crate::model::emission::{Emission, NoiseInput};
use crate::model::flow::{FlowConstants, StepBounds};
use crate::model::goal_frame::GoalFrame;
use crate::model::guidance::Guidance;
use crate::model::network::Layers;
use crate::model::own_motion;
use crate::model::tensor_backend::{TensorBackend, TensorEngine};
use ddl_core::{HORIZON, OBSERVED};
use ddl_network::backbone::Backbone;
use ddl_network::backend::Memory;
use ddl_network::{NetworkFrame, StepRule};
use std::slice::from_ref;
use tch::{Kind, Tensor};

/// The forecast from observed frames: positions, and the factors that shaped them.
#[derive(Debug)]
pub(crate) struct Rollout {
    /// `[12, H, P, 2]`, metres.
    pub(crate) positions: Tensor,
    /// `[12, H, P, 3]`: (a, b, c) of L = [[a, 0], [b, c]], in (m/s)^(1/2), of the step to each position; `None`
    /// for the variants without dynamics.
    pub(crate) factors: Option<Tensor>,
}

/// A backend, and the backbone in its operations.
type BackbonePass<'a, B> = (&'a B, &'a dyn Backbone<B>);

impl Layers {
    /// One-step-ahead positions: the next position from the true positions up to each frame.
    ///
    /// # Shapes
    /// `batch` of T frames with neighbours of at least T - 1, where T is at least 8 in the pedestrians' own frames and
    /// without goal shift; `goals` `[P, 2]`; `noise` one vector or none -> `[T - 1, P, 2]`, the forecasts of frames
    /// 1..T.
    pub(crate) fn teacher_forced(
        &self,
        batch: &WindowBatch,
        goals: &Tensor,
        noise: &NoiseInput,
        pass: TensorEngine<'_>,
    ) -> Tensor {
        let noise = (noise, &pass.noise_weight(self.output, &self.config));
        match pass {
            TensorEngine::Torch(backend) => self.teacher_forced_by(batch, goals, noise, (backend, &*self.on_tensors)),
            TensorEngine::Kernels(pass) => self.teacher_forced_by(batch, goals, noise, (&pass.backend, &*self.on_rows)),
        }
    }

    fn teacher_forced_by<B: TensorBackend>(
        &self,
        batch: &WindowBatch,
        goals: &Tensor,
        (noise, noise_weight): (&NoiseInput, &Tensor),
        (backend, backbone): BackbonePass<'_, B>,
    ) -> Tensor {
        let steps = batch.positions.size()[0] as usize - 1;
        let positions = batch.positions.narrow(0, 0, steps as i64);
        // The frames are known, so the backbone encodes all their scenes at once.
        let centred = backend.given(&centre(batch, &positions));
        let scenes = backbone.scene(backend, &centred, &backend.seen(batch, 0..steps));
        let scenes = backend.each_entry(&scenes);
        let guidance = self.guidance(batch, goals, StepRule::Euler);
        let before = Tensor::cat(&[positions.narrow(0, 0, 1), positions.narrow(0, 0, steps as i64 - 1)], 0);
        let relative = backend.each_entry(&backend.given(&guidance.seen(&positions, &before)));
        let mut memory = Memory::default();
        let features: Vec<B::Tokens> = (0..steps)
            .map(|t| {
                let seen = backend.seen(batch, t..t + 1);
                backbone.step(backend, &mut memory, &relative[t], &scenes[t], &seen)
            })
            .collect();
        let shape = [1, positions.size()[1]];
        let dynamics = self.config.variant.dynamics();
        let emission = Emission::new(backend, self.output, noise_weight, noise, shape, dynamics);
        let emitted = guidance.to_world(&emission.factors(backend, &features));
        guidance.next_positions(&positions, goals, &emitted, (0, steps))
    }

    /// Forecast positions: 8 observed frames, then every forecast is the input of the next step. Gradients flow back
    /// through positions and memory only.
    ///
    /// At all forecast steps the neighbours are those of the last observed frame. H = G hypotheses with one goal each,
    /// or H = number of noise vectors for a single goal (G = 1).
    ///
    /// # Shapes
    /// `batch` of at least 8 frames; `goals` `[G, P, 2]`; `noise` 1 or H vectors, or none -> positions
    /// `[12, H, P, 2]` and factors `[12, H, P, 3]`.
    pub(crate) fn roll_out(
        &self,
        batch: &WindowBatch,
        goals: &Tensor,
        noise: &NoiseInput,
        rule: StepRule,
        pass: TensorEngine<'_>,
    ) -> Rollout {
        let noise = (noise, &pass.noise_weight(self.output, &self.config));
        match pass {
            TensorEngine::Torch(backend) => self.roll_out_by(batch, goals, noise, rule, (backend, &*self.on_tensors)),
            TensorEngine::Kernels(pass) => self.roll_out_by(batch, goals, noise, rule, (&pass.backend, &*self.on_rows)),
        }
    }

    fn roll_out_by<B: TensorBackend>(
        &self,
        batch: &WindowBatch,
        goals: &Tensor,
        (noise, noise_weight): (&NoiseInput, &Tensor),
        rule: StepRule,
        (backend, backbone): BackbonePass<'_, B>,
    ) -> Rollout {
        let observed = batch.positions.narrow(0, 0, OBSERVED as i64);
        let last = OBSERVED as i64 - 1;
        let hypotheses = goals.size()[0].max(noise.count());
        let shape = [hypotheses, observed.size()[1]];
        let shaped = self.config.variant.dynamics();
        let emission = Emission::new(backend, self.output, noise_weight, noise, shape, shaped);
        let guidance = self.guidance(batch, goals, rule);
        let (mut features, mut memory) = observe(batch, &guidance, (backend, backbone));
        if backend.entries(&features) < hypotheses as usize {
            features = backend.repeated(&features, hypotheses as usize);
            memory = memory.repeated(backend, hypotheses as usize);
        }
        let seen = backend.seen(batch, OBSERVED - 1..OBSERVED);
        let mut position = observed.narrow(0, last, 1).expand([hypotheses, -1, -1], false);
        let mut sum =
            observed.sum_dim_intlist([0i64].as_slice(), true, None::<Kind>).expand([hypotheses, -1, -1], false);
        let mut path = Vec::with_capacity(HORIZON);
        let mut factors = Vec::with_capacity(HORIZON);
        for t in OBSERVED..OBSERVED + HORIZON {
            let emitted = guidance.to_world(&emission.factors(backend, from_ref(&features)));
            let before = position.detach();
            let steps = (t - OBSERVED, OBSERVED + HORIZON - t);
            position = guidance.next_positions(&position, goals, &emitted, steps);
            path.push(position.shallow_clone());
            factors.push(emitted);
            if t + 1 < OBSERVED + HORIZON {
                let position = position.detach();
                sum = &sum + &position;
                let centred = &position - batch.rows.means(&sum) / (t + 1) as f64;
                let scene = backbone.scene(backend, &backend.given(&centred), &seen);
                let relative = backend.given(&guidance.seen(&position, &before));
                features = backbone.step(backend, &mut memory, &relative, &scene, &seen);
            }
        }
        Rollout { positions: Tensor::stack(&path, 0), factors: shaped.then(|| Tensor::stack(&factors, 0)) }
    }

    /// Goals and frames of the pedestrians for this network. Shapes: `batch` of at least 8 frames, unless the network
    /// reads positions relative to the goal in the world's frame; `goals` `[.., P, 2]`.
    fn guidance(&self, batch: &WindowBatch, goals: &Tensor, rule: StepRule) -> Guidance {
        let config = &self.config;
        let time_step = config.time_step;
        let observed = || batch.positions.narrow(0, 0, OBSERVED as i64);
        let last = || batch.positions.narrow(0, OBSERVED as i64 - 1, 1);
        let goals = if goals.dim() == 2 { goals.unsqueeze(0) } else { goals.shallow_clone() };
        let frame = match config.frame {
            NetworkFrame::World => None,
            NetworkFrame::Goal => Some(GoalFrame::new(&observed(), &goals, time_step)),
        };
        Guidance {
            reference: if config.variant.goal_shift() { goals } else { last() },
            frame,
            dynamics: config.variant.dynamics(),
            constants: FlowConstants { sigma: config.sigma, time_step },
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

/// The features of the last observed frame, and the memory of all observed ones. The hypotheses differ only in the goal
/// that positions are relative to, so there is one batch entry for each distinct reference.
fn observe<B: TensorBackend>(
    batch: &WindowBatch,
    guidance: &Guidance,
    (backend, backbone): BackbonePass<'_, B>,
) -> (B::Tokens, Memory<B>) {
    let observed = batch.positions.narrow(0, 0, OBSERVED as i64);
    let centred = backend.given(&centre(batch, &observed));
    let scenes = backend.each_entry(&backbone.scene(backend, &centred, &backend.seen(batch, 0..OBSERVED)));
    let mut memory = Memory::default();
    let mut step = |t: usize| {
        let position = |t: usize| observed.get(t as i64);
        let relative = backend.given(&guidance.seen(&position(t), &position(t.saturating_sub(1))));
        let seen = backend.seen(batch, t..t + 1);
        backbone.step(backend, &mut memory, &relative, &scenes[t], &seen)
    };
    let mut features = step(0);
    for t in 1..OBSERVED {
        features = step(t);
    }
    (features, memory)
}

/// Positions relative to the mean over all pedestrians of the scene and all frames so far.
/// Shapes: `positions` `[T, P, 2]` -> the same.
fn centre(batch: &WindowBatch, positions: &Tensor) -> Tensor {
    let frames = positions.size()[0];
    let count = Tensor::arange_start(1, frames + 1, (positions.kind(), positions.device())).view([frames, 1, 1]);
    positions - batch.rows.means(&(positions.cumsum(0, positions.kind()) / count))
}
