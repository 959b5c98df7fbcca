//! The forecast frames of a rollout on plain numbers, where kernels compute the network: libtorch would spend as long on
//! the forty small operations between two of its steps as the kernels on the network.

use std::rc::Rc;

use ddl_data::OBSERVED;
use ddl_dynamics::{
    Attractor, CholeskyMetric, DynamicsError, Euler, MotionBounds, NaturalGradientFlow,
    StableEuler, StepTime, rollout_into,
};
use nalgebra::Vector2;
use tch::{Kind, Tensor};

use super::Course;
use crate::batch::SceneBatch;
use crate::emission::Emission;
use crate::goal_frame::FrameNumbers;
use crate::kernel::Buffer;
use crate::neighbours::Seen;
use crate::numbers::{numbers, tensor};
use crate::pass::Pass;
use crate::rollout::Rollout;
use crate::star::{GraphMemory, StarNetwork};
use crate::tokens::{Rows, Tokens};

/// Everybody in every hypothesis, `[H, P, 2]` each, metres.
#[derive(Debug)]
pub(super) struct OnRows {
    positions: Buffer,
    /// A step ago.
    before: Buffer,
    /// Over all frames so far.
    sums: Buffer,
    goals: Buffer,
    /// What the network's temporal positions are relative to.
    references: Buffer,
    /// The frame of everybody, `[H, P]`; `None` for that of the world.
    frames: Option<Vec<FrameNumbers>>,
    /// Motion bounds of each hypothesis and pedestrian, `[H, P]`; `None` for plain Euler steps.
    bounds: Option<Vec<MotionBounds<f32>>>,
}

impl OnRows {
    /// After the observed frames.
    ///
    /// # Shapes
    /// `batch` of P walkers; `goals` `[G, P, 2]`, in `hypotheses` hypotheses.
    pub(super) fn new(
        batch: &SceneBatch,
        goals: &Tensor,
        course: &Course,
        hypotheses: i64,
    ) -> Self {
        let observed = batch.positions.narrow(0, 0, OBSERVED as i64);
        let last = observed.narrow(0, OBSERVED as i64 - 1, 1);
        let sum = observed.sum_dim_intlist([0i64].as_slice(), true, None::<Kind>);
        let each = |x: &Tensor| numbers(&x.expand([hypotheses, -1, -1], false));
        Self {
            positions: each(&last),
            before: each(&last),
            sums: each(&sum),
            goals: each(goals),
            references: each(&course.reference),
            frames: course.frame.as_ref().map(|frame| frame.numbers(hypotheses)),
            bounds: course.bounds.as_ref().map(|bounds| {
                let shape = |width: i64| [hypotheses, batch.walkers() as i64, width];
                let each = |x: &Tensor, width: i64| numbers(&x.expand(shape(width), false));
                let (tops, shares) = (each(&bounds.top_speed, 1), each(&bounds.share, 1));
                let velocities = each(&bounds.velocity, 2);
                let (velocities, _) = velocities.as_chunks::<2>();
                let all = tops.iter().zip(velocities).zip(shares.iter());
                // Invalid speeds are reported by the rollout in f64, which has the same bounds.
                all.map(|((&top, &own), &share)| MotionBounds::new(top, own.into(), share))
                    .map(Option::unwrap_or_default)
                    .map(|each| {
                        if bounds.absolute {
                            each.absolute()
                        } else {
                            each
                        }
                    })
                    .collect()
            }),
        }
    }

    /// Goes on for `horizon` frames, with the tokens and the memory of the last observed one.
    pub(super) fn walk(
        mut self,
        network: &StarNetwork,
        batch: &SceneBatch,
        emission: &Emission<'_>,
        (mut token, mut memory): (Tokens, GraphMemory),
        (seen, pass): (&Seen, &Pass),
        horizon: usize,
    ) -> Rollout {
        let [hypotheses, walkers] = [token.entries(), batch.walkers()];
        let noise = emission.noise_rows([hypotheses, walkers], pass);
        let shaped = network.config().variant.dynamics();
        let (mut path, mut factors) = (Vec::new(), Vec::new());
        for t in OBSERVED..OBSERVED + horizon {
            let mut emitted = emission.of_rows(&token, &noise, pass);
            self.turn_to_world(&mut emitted, shaped);
            self.before.copy_from_slice(&self.positions);
            if shaped {
                self.follow(&emitted, network, (t - OBSERVED, OBSERVED + horizon - t));
                factors.extend_from_slice(&emitted);
            } else {
                for ((p, r), e) in self.places().zip(emitted.iter()) {
                    *p = r + e;
                }
            }
            path.extend_from_slice(&self.positions);
            if t + 1 < OBSERVED + horizon {
                let shape = [hypotheses, walkers, 2];
                let centred = rows(shape, self.centred(batch, t + 1));
                let spatial = network.spatial_tokens(&centred, seen, pass);
                let inputs = network.config().temporal_inputs() as usize;
                let relative = self.relative(network.config().time_step as f32);
                let relative = rows([hypotheses, walkers, inputs], relative);
                token = network.step(&mut memory, &relative, &spatial, seen, pass);
            }
        }
        let shape = |width: i64| [horizon as i64, hypotheses as i64, walkers as i64, width];
        Rollout {
            positions: tensor(&path, &shape(2)),
            factors: shaped.then(|| tensor(&factors, &shape(3))),
        }
    }

    /// Each coordinate with that of its reference.
    fn places(&mut self) -> impl Iterator<Item = (&mut f32, &f32)> {
        self.positions.iter_mut().zip(self.references.iter())
    }

    /// What the output layer says, in the frame of the world: factors where the flow is `shaped`, vectors otherwise.
    fn turn_to_world(&self, emitted: &mut [f32], shaped: bool) {
        let Some(frames) = &self.frames else { return };
        if shaped {
            let (factors, _) = emitted.as_chunks_mut::<3>();
            for (factor, frame) in factors.iter_mut().zip(frames) {
                *factor = frame.factor_to_world(*factor);
            }
        } else {
            let (vectors, _) = emitted.as_chunks_mut::<2>();
            for (vector, frame) in vectors.iter_mut().zip(frames) {
                *vector = frame.to_world(*vector);
            }
        }
    }

    /// One step of the dynamics for everybody, by the reference implementation.
    fn follow(&mut self, factors: &[f32], network: &StarNetwork, (done, left): (usize, usize)) {
        let config = network.config();
        let (sigma, dt) = (config.sigma as f32, config.time_step as f32);
        let time = StepTime { done, left, dt };
        let (places, _) = self.positions.as_chunks_mut::<2>();
        let (goals, _) = self.goals.as_chunks::<2>();
        let (factors, _) = factors.as_chunks::<3>();
        for (i, ((place, goal), factor)) in places.iter_mut().zip(goals).zip(factors).enumerate() {
            let bounds = self.bounds.as_ref().map(|bounds| &bounds[i]);
            // What the network makes of numbers that are none is no number, and told by whoever walks the same way in f64.
            *place = next(*place, *goal, *factor, (sigma, time), bounds).unwrap_or([f32::NAN; 2]);
        }
    }

    /// Relative to the mean over all walkers of the scene and all `frames` so far, the newest included.
    fn centred(&mut self, batch: &SceneBatch, frames: usize) -> Buffer {
        for (sum, position) in self.sums.iter_mut().zip(self.positions.iter()) {
            *sum += position;
        }
        let mut centred = Buffer::copy(&self.positions);
        let (sums, _) = self.sums.as_chunks::<2>();
        let (places, _) = centred.as_chunks_mut::<2>();
        let walkers = batch.walkers();
        let entries = places.chunks_exact_mut(walkers);
        for (places, sums) in entries.zip(sums.chunks_exact(walkers)) {
            for scene in batch.neighbours.scenes() {
                let mut mean = [0.0; 2];
                for [x, y] in &sums[scene.clone()] {
                    mean[0] += x;
                    mean[1] += y;
                }
                let share = 1.0 / (scene.len() * frames) as f32;
                for [x, y] in &mut places[scene.clone()] {
                    *x -= mean[0] * share;
                    *y -= mean[1] * share;
                }
            }
        }
        centred
    }

    /// Where everybody is, as the temporal encoders read it.
    fn relative(&self, time_step: f32) -> Buffer {
        let mut relative = Buffer::copy(&self.positions);
        for (x, reference) in relative.iter_mut().zip(self.references.iter()) {
            *x -= reference;
        }
        let Some(frames) = &self.frames else {
            return relative;
        };
        let mut inputs = Buffer::any(2 * relative.len());
        let (rows, _) = inputs.as_chunks_mut::<4>();
        let (places, _) = relative.as_chunks::<2>();
        let (positions, _) = self.positions.as_chunks::<2>();
        let (before, _) = self.before.as_chunks::<2>();
        let walkers = places.iter().zip(positions.iter().zip(before)).zip(frames);
        for (row, ((place, (now, before)), frame)) in rows.iter_mut().zip(walkers) {
            let velocity = [0, 1].map(|axis| (now[axis] - before[axis]) / time_step);
            let ([x, y], [vx, vy]) = (frame.of_world(*place), frame.of_world(velocity));
            *row = [x, y, vx, vy];
        }
        inputs
    }
}

fn rows(shape: [usize; 3], numbers: Buffer) -> Tokens {
    Tokens::Rows(Rc::new(Rows::new(shape, numbers)))
}

fn next(
    place: [f32; 2],
    goal: [f32; 2],
    [a, b, c]: [f32; 3],
    (sigma, time): (f32, StepTime<f32>),
    bounds: Option<&MotionBounds<f32>>,
) -> Result<[f32; 2], DynamicsError> {
    let attractor = Attractor::new(Vector2::from(goal))?;
    let metric = CholeskyMetric::planar(a, b, c, sigma)?;
    let start = Vector2::from(place);
    let mut path = [start; 2];
    match bounds {
        None => {
            let flow = NaturalGradientFlow::new(attractor, metric);
            rollout_into(&flow, &Euler, start, time.dt, &mut path)?;
        }
        Some(bounds) => {
            let metric = bounds.shape(&metric, &(attractor.goal() - start), time);
            let flow = NaturalGradientFlow::new(attractor, metric);
            rollout_into(&flow, &StableEuler, start, time.dt, &mut path)?;
        }
    }
    Ok(path[1].into())
}
