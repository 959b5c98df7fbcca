//! The state of a rollout: positions of a batch's pedestrians, the inputs of the network, and the step to the next
//! positions.

use crate::StarConfig;
use crate::backend::{Buffer, Rows, Scenes, VisibleScenes};
use crate::config::NetworkFrame;
use crate::forecast::batch::ForecastBatch;
use crate::forecast::bounded_steps::BoundedSteps;
use crate::forecast::motion_bounds::motion_bounds;
use crate::forecast::one_step::{around, next};
use crate::forecast::own_frame::{OwnFrame, length_unit};
use crate::forecast::rollout::StepRule;
use crate::forecast::visibility::visibility;
use ddl_core::{OBSERVED, Position, Window};
use ddl_dynamics::{MotionBounds, StepTime};
use ddl_simd::Dispatch;
use std::ops::Range;
use std::rc::Rc;
use std::sync::Arc;

/// The observation of a batch in metres, the same for all hypotheses.
pub(super) struct ObservedSteps<'a> {
    config: &'a StarConfig,
    /// `[8, P]`.
    observed: Vec<[f32; 2]>,
    scenes: Arc<Scenes>,
    pedestrians: usize,
    /// Bounds of each pedestrian's motion, `[P]`; `None` for Euler steps.
    bounds: Option<Vec<MotionBounds<f32>>>,
    /// Sum of the 8 observed positions of each pedestrian, `[P]`.
    sums: Vec<[f32; 2]>,
    /// Batch entries at an observed time step: G if the inputs are relative to the goals, otherwise 1.
    pub(super) entries: usize,
}

/// The state of a rollout of some hypotheses, in metres.
pub(super) struct RolloutState<'a> {
    observation: &'a ObservedSteps<'a>,
    /// Origins of the positions that the temporal encoders read, `[E, P]`: the goals (E = G), or the last observed
    /// positions (E = 1).
    references: Vec<[f32; 2]>,
    /// `[E, P]`; `None` for [`NetworkFrame::World`].
    frames: Option<Vec<OwnFrame>>,
    /// `[G, P]`.
    goals: Vec<[f32; 2]>,
    /// Newest positions, `[H, P]`.
    pub(super) positions: Vec<[f32; 2]>,
    /// Positions one time step before, `[H, P]`.
    pub(super) before: Vec<[f32; 2]>,
    /// Sums of the positions so far, `[H, P]`.
    sums: Vec<[f32; 2]>,
}

impl<'a> ObservedSteps<'a> {
    pub(super) fn new(batch: &ForecastBatch<'_>, config: &'a StarConfig) -> Self {
        let pedestrians = batch.pedestrians();
        let tracks = || tracks(batch);
        let positions = |t: usize| tracks().map(move |track| track[t].map(|x| x as f32));
        let observed: Vec<[f32; 2]> = (0..OBSERVED).flat_map(positions).collect();
        let bounds = (batch.rule == StepRule::Bounded).then(|| {
            let share = |i: usize| batch.shares.as_ref().map_or(1.0, |shares| shares[i]);
            let absolute = config.frame == NetworkFrame::World;
            tracks()
                .enumerate()
                .map(|(i, track)| {
                    let bounds = motion_bounds(track, config.time_step, share(i));
                    single(&bounds, absolute)
                })
                .collect()
        });
        let mut sums = vec![[0.0; 2]; pedestrians];
        for positions in observed.chunks_exact(pedestrians) {
            add(&mut sums, positions);
        }
        let windows: Vec<&Window> = batch.windows.iter().collect();
        Self {
            config,
            scenes: Arc::new(visibility(&windows, OBSERVED, config.neighbour_box)),
            entries: if config.variant.goal_shift() { batch.goals.len() } else { 1 },
            observed,
            pedestrians,
            bounds,
            sums,
        }
    }

    pub(super) fn seen(&self, steps: Range<usize>) -> VisibleScenes {
        VisibleScenes { scenes: Arc::clone(&self.scenes), steps }
    }

    /// Observed positions relative to the mean over the scene and all time steps so far, `[8, P, 2]`.
    pub(super) fn centred(&self) -> Rc<Rows> {
        let mut sums = vec![[0.0; 2]; self.pedestrians];
        let mut centred = Buffer::copy(self.observed.as_flattened());
        let (places, _) = centred.as_chunks_mut::<2>();
        let steps = places.chunks_exact_mut(self.pedestrians);
        for (t, places) in steps.enumerate() {
            add(&mut sums, places);
            self.centre(places, &sums, t + 1);
        }
        rows([OBSERVED, self.pedestrians, 2], centred)
    }

    fn at(&self, t: usize) -> &[[f32; 2]] {
        &self.observed[t * self.pedestrians..][..self.pedestrians]
    }

    fn centre(&self, places: &mut [[f32; 2]], sums: &[[f32; 2]], steps: usize) {
        for scene in self.scenes.ranges() {
            let mut mean = [0.0; 2];
            for [x, y] in &sums[scene.clone()] {
                mean[0] += x;
                mean[1] += y;
            }
            let share = 1.0 / (scene.len() * steps) as f32;
            for [x, y] in &mut places[scene.clone()] {
                *x -= mean[0] * share;
                *y -= mean[1] * share;
            }
        }
    }

    fn time_step(&self) -> f32 {
        self.config.time_step as f32
    }
}

impl<'a> RolloutState<'a> {
    /// The state before the first forecast step, for some hypotheses. A single goal is used for all hypotheses.
    pub(super) fn new(observation: &'a ObservedSteps<'_>, batch: &ForecastBatch<'_>, hypotheses: Range<usize>) -> Self {
        let config = observation.config;
        let count = hypotheses.len();
        let used = if batch.goals.len() == 1 { 0..1 } else { hypotheses };
        let goals = &batch.goals[used];
        let frames = (config.frame == NetworkFrame::Goal).then(|| {
            let frames = goals.iter().flat_map(|goals| {
                tracks(batch).zip(goals).map(|(track, &goal)| {
                    let unit = length_unit(track, config.time_step);
                    OwnFrame::new(track[OBSERVED - 1], goal, unit)
                })
            });
            frames.collect()
        });
        let goals: Vec<[f32; 2]> = goals.iter().flatten().map(|goal| goal.map(|x| x as f32)).collect();
        let last = observation.at(OBSERVED - 1);
        Self {
            references: if config.variant.goal_shift() { goals.clone() } else { last.to_vec() },
            frames,
            goals,
            positions: last.repeat(count),
            before: last.repeat(count),
            sums: observation.sums.repeat(count),
            observation,
        }
    }

    /// Newest positions relative to the mean over the scene and the `steps` time steps so far, `[H, P, 2]`. Adds them
    /// to the mean.
    pub(super) fn centred(&mut self, steps: usize) -> Rc<Rows> {
        add(&mut self.sums, &self.positions);
        let pedestrians = self.observation.pedestrians;
        let mut centred = Buffer::copy(self.positions.as_flattened());
        let (places, _) = centred.as_chunks_mut::<2>();
        let entries = places.chunks_exact_mut(pedestrians);
        for (places, sums) in entries.zip(self.sums.chunks_exact(pedestrians)) {
            self.observation.centre(places, sums, steps);
        }
        rows([self.positions.len() / pedestrians, pedestrians, 2], centred)
    }

    /// Inputs of the temporal encoders at an observed time step, `[E, P, inputs]`.
    pub(super) fn observed_relative(&self, t: usize) -> Rc<Rows> {
        self.relative(self.observation.at(t), self.observation.at(t.saturating_sub(1)))
    }

    /// Inputs of the temporal encoders from `positions` and the positions one step before, `[1 or H, P]`: relative to
    /// the references and, in the pedestrians' own frames, with the velocity.
    pub(super) fn relative(&self, positions: &[[f32; 2]], before: &[[f32; 2]]) -> Rc<Rows> {
        let count = positions.len().max(self.references.len());
        let pedestrians = self.observation.pedestrians;
        let (entries, time_step) = (count / pedestrians, self.observation.time_step());
        let place = |i: usize| {
            let (now, reference) = (around(positions, i), around(&self.references, i));
            [now[0] - reference[0], now[1] - reference[1]]
        };
        let Some(frames) = &self.frames else {
            let mut numbers = Buffer::any(2 * count);
            let (places, _) = numbers.as_chunks_mut::<2>();
            for (i, row) in places.iter_mut().enumerate() {
                *row = place(i);
            }
            return rows([entries, pedestrians, 2], numbers);
        };
        let mut numbers = Buffer::any(4 * count);
        let (places, _) = numbers.as_chunks_mut::<4>();
        for (i, row) in places.iter_mut().enumerate() {
            let (now, earlier) = (around(positions, i), around(before, i));
            let velocity = [0, 1].map(|axis| (now[axis] - earlier[axis]) / time_step);
            let frame = around(frames, i);
            let ([x, y], [vx, vy]) = (frame.of_world(place(i)), frame.of_world(velocity));
            *row = [x, y, vx, vy];
        }
        rows([entries, pedestrians, 4], numbers)
    }

    /// Moves the pedestrians one step by the output of the network, `[H, P, outputs]`: factors (a, b, c) or vectors in
    /// the pedestrians' frames. Afterwards the factors are in the frame of the world. `steps`: the numbers of steps
    /// done and of steps left, including this one.
    pub(super) fn advance(&mut self, emitted: &mut [f32], steps: (usize, usize)) {
        self.before.copy_from_slice(&self.positions);
        if self.observation.config.variant.dynamics() {
            let (factors, _) = emitted.as_chunks_mut::<3>();
            self.follow(factors, steps);
        } else {
            let (vectors, _) = emitted.as_chunks::<2>();
            for (i, (place, &vector)) in self.positions.iter_mut().zip(vectors).enumerate() {
                let frames = self.frames.as_deref();
                let [x, y] = frames.map_or(vector, |frames| around(frames, i).to_world(vector));
                let reference = around(&self.references, i);
                *place = [reference[0] + x, reference[1] + y];
            }
        }
    }

    fn follow(&mut self, factors: &mut [[f32; 3]], (done, left): (usize, usize)) {
        let ObservedSteps { config, bounds, .. } = self.observation;
        let (sigma, dt) = (config.sigma as f32, self.observation.time_step());
        let time = StepTime { done, left, dt };
        if let Some(frames) = &self.frames {
            for (factor, frame) in factors.iter_mut().zip(frames.iter().cycle()) {
                *factor = frame.factor_to_world(*factor);
            }
            if let Some(bounds) = bounds {
                return Dispatch::detect().run(BoundedSteps {
                    positions: &mut self.positions,
                    goals: &self.goals,
                    factors,
                    bounds,
                    sigma,
                    time,
                });
            }
        }
        for (i, (place, factor)) in self.positions.iter_mut().zip(factors).enumerate() {
            let bounds = bounds.as_ref();
            let bounds = bounds.map(|bounds| &bounds[i % self.observation.pedestrians]);
            *place = next(*place, around(&self.goals, i), *factor, (sigma, time), bounds);
        }
    }
}

fn add(sums: &mut [[f32; 2]], terms: &[[f32; 2]]) {
    for (sum, term) in sums.iter_mut().zip(terms) {
        sum[0] += term[0];
        sum[1] += term[1];
    }
}

fn rows(shape: [usize; 3], numbers: Buffer) -> Rc<Rows> {
    Rc::new(Rows::new(shape, numbers))
}

fn tracks<'a>(batch: &'a ForecastBatch<'_>) -> impl Iterator<Item = &'a [Position]> {
    batch.windows.iter().flat_map(|window| (0..window.len()).map(|i| window.observed(i)))
}

/// The bounds in single precision. The integration in `f64`, which has the same bounds, reports invalid speeds.
fn single(bounds: &MotionBounds<f64>, absolute: bool) -> MotionBounds<f32> {
    let velocity = bounds.velocity().map(|x| x as f32);
    let (top, share) = (bounds.top_speed() as f32, bounds.share() as f32);
    let single = MotionBounds::new(top, velocity, share).unwrap_or_default();
    if absolute { single.absolute() } else { single }
}
