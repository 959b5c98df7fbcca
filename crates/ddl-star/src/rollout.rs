//! From windows and goals to positions: teacher-forced for training, recurrent for forecasts.

mod on_rows;

use crate::batch::SceneBatch;
use crate::emission::NoiseInput;
use crate::flow::{FlowConstants, StepRule, natural_gradient_step};
use crate::layers::Mode;
use crate::pass::Pass;
use crate::star::{GraphMemory, StarNetwork};
use crate::tokens::Tokens;
use ddl_data::OBSERVED;
use on_rows::OnRows;
use std::ops::Range;
use std::slice::from_ref;
use tch::{Kind, Tensor};

/// What the network made of observed frames: where everybody goes, and what shaped the way.
#[derive(Debug)]
#[non_exhaustive]
pub struct Rollout {
    /// `[horizon, H, P, 2]`, metres.
    pub positions: Tensor,
    /// `[horizon, H, P, 3]`: (a, b, c) of L = [[a, 0], [b, c]], in (m/s)^(1/2), with which each position
    /// was reached; `None` for the variants without dynamics.
    pub factors: Option<Tensor>,
}

impl StarNetwork {
    /// One-step-ahead positions: from the true positions up to each frame, the next one.
    ///
    /// # Shapes
    /// `batch` of T frames with neighbours of at least T - 1; `goals` `[P, 2]`; `noise`
    /// one vector, or none -> `[T - 1, P, 2]`, the forecasts of frames 1..T.
    pub fn teacher_forced(
        &self,
        batch: &SceneBatch,
        goals: &Tensor,
        noise: &NoiseInput,
        mode: Mode,
    ) -> Tensor {
        self.teacher_forced_in(batch, goals, noise, &self.pass(mode))
    }

    /// [`teacher_forced`](Self::teacher_forced) in a pass of its own.
    pub(crate) fn teacher_forced_in(
        &self,
        batch: &SceneBatch,
        goals: &Tensor,
        noise: &NoiseInput,
        pass: &Pass,
    ) -> Tensor {
        let steps = batch.positions.size()[0] as usize - 1;
        let positions = batch.positions.narrow(0, 0, steps as i64);
        let seen = |frames: Range<usize>| batch.neighbours.during(frames);
        // The frames are known, so all of them pass the first spatial encoder at once.
        let centred = Tokens::of(&centre(batch, &positions), pass);
        let spatial = self
            .spatial_tokens(&centred, &seen(0..steps), pass)
            .each_entry(pass);
        let reference = self.reference(batch, goals);
        let relative = Tokens::of(&(&positions - &reference), pass).each_entry(pass);
        let mut memory = GraphMemory::default();
        let tokens: Vec<Tokens> = (0..steps)
            .map(|t| {
                self.step(
                    &mut memory,
                    &relative[t],
                    &spatial[t],
                    &seen(t..t + 1),
                    pass,
                )
            })
            .collect();
        let emitted = self.emission(noise).of(&Tokens::joined(&tokens, pass));
        self.next_positions(&positions, goals, &reference, &emitted, StepRule::Euler)
    }

    /// Forecast positions: 8 frames observed, then every forecast is the input of the next step.
    ///
    /// Neighbours are those of the last observed frame throughout. H = G hypotheses with one goal
    /// each, or H = number of noise vectors when all share one goal (G = 1).
    ///
    /// # Shapes
    /// `batch` of at least 8 frames; `goals` `[G, P, 2]`; `noise` 1 or H vectors, or none
    /// -> positions `[horizon, H, P, 2]` and factors `[horizon, H, P, 3]`.
    pub fn roll_out(
        &self,
        batch: &SceneBatch,
        goals: &Tensor,
        noise: &NoiseInput,
        horizon: usize,
        rule: StepRule,
    ) -> Rollout {
        let pass = &self.pass(Mode::Evaluate);
        let observed = batch.positions.narrow(0, 0, OBSERVED as i64);
        let last = OBSERVED as i64 - 1;
        let hypotheses = goals.size()[0].max(noise.count());
        let reference = self.reference(batch, goals);
        let spatial = self.spatial_tokens(
            &Tokens::of(&centre(batch, &observed), pass),
            &batch.neighbours.during(0..OBSERVED),
            pass,
        );
        // The observed frames differ between hypotheses only through the goal they are shifted by:
        // `relative` has one batch entry a distinct reference.
        let mut memory = GraphMemory::default();
        let mut observe = |t: usize| {
            let relative = Tokens::of(&(observed.get(t as i64) - &reference), pass);
            let seen = batch.neighbours.during(t..t + 1);
            self.step(&mut memory, &relative, &spatial.entry(t, pass), &seen, pass)
        };
        let mut token = observe(0);
        for t in 1..OBSERVED {
            token = observe(t);
        }
        if token.entries() < hypotheses as usize {
            token = token.repeated(hypotheses as usize, pass);
            memory = memory.expand_batch(hypotheses);
        }
        let seen = batch.neighbours.during(OBSERVED - 1..OBSERVED);
        let emission = self.emission(noise);
        if let Tokens::Rows(_) = token {
            return OnRows::new(batch, goals, &reference, hypotheses, rule).walk(
                self,
                batch,
                &emission,
                (token, memory),
                (&seen, pass),
                horizon,
            );
        }
        let mut position = observed
            .narrow(0, last, 1)
            .expand([hypotheses, -1, -1], false);
        let mut sum = observed
            .sum_dim_intlist([0i64].as_slice(), true, None::<Kind>)
            .expand([hypotheses, -1, -1], false);
        let mut path = Vec::with_capacity(horizon);
        let mut factors = Vec::with_capacity(horizon);
        for t in OBSERVED..OBSERVED + horizon {
            let emitted = emission.of(&Tokens::joined(from_ref(&token), pass));
            position = self.next_positions(&position, goals, &reference, &emitted, rule);
            path.push(position.shallow_clone());
            factors.push(emitted);
            if t + 1 < OBSERVED + horizon {
                sum = &sum + &position;
                let centred = &position - batch.scene_means.of(&sum) / (t + 1) as f64;
                let spatial = self.spatial_tokens(&Tokens::of(&centred, pass), &seen, pass);
                let relative = Tokens::of(&(&position - &reference), pass);
                token = self.step(&mut memory, &relative, &spatial, &seen, pass);
            }
        }
        let shaped = self.config().variant.dynamics();
        Rollout {
            positions: Tensor::stack(&path, 0),
            factors: shaped.then(|| Tensor::stack(&factors, 0)),
        }
    }

    /// What temporal positions are relative to: the goal, or the last observed position.
    ///
    /// # Shapes
    /// `goals` `[.., P, 2]` -> `[G or 1, P, 2]`.
    fn reference(&self, batch: &SceneBatch, goals: &Tensor) -> Tensor {
        if self.config().variant.goal_shift() {
            if goals.dim() == 2 {
                goals.unsqueeze(0)
            } else {
                goals.shallow_clone()
            }
        } else {
            batch.positions.narrow(0, OBSERVED as i64 - 1, 1)
        }
    }

    fn next_positions(
        &self,
        positions: &Tensor,
        goals: &Tensor,
        reference: &Tensor,
        emitted: &Tensor,
        rule: StepRule,
    ) -> Tensor {
        if !self.config().variant.dynamics() {
            return reference + emitted;
        }
        let config = self.config();
        let constants = FlowConstants {
            sigma: config.sigma,
            time_step: config.time_step,
            rule,
        };
        natural_gradient_step(positions, goals, emitted, constants)
    }
}

/// Positions relative to the mean over all walkers of the scene and all frames so far.
///
/// # Shapes
/// `positions` `[T, P, 2]` -> the same.
fn centre(batch: &SceneBatch, positions: &Tensor) -> Tensor {
    let frames = positions.size()[0];
    let count = Tensor::arange_start(1, frames + 1, (positions.kind(), positions.device()))
        .view([frames, 1, 1]);
    positions
        - batch
            .scene_means
            .of(&(positions.cumsum(0, positions.kind()) / count))
}
