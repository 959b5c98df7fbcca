//! The rollout of one batch of windows, some hypotheses at a time.

use super::batch::{BatchRollout, ForecastBatch};
use super::course::{Course, Observation};
use super::emission::NoiseSpread;
use crate::StarConfig;
use crate::backbone::Backbone;
use crate::backend::{Backend as _, Buffer, KernelBackend, Memory, Rows};
use crate::weights::Linear;
use ddl_data::{HORIZON, OBSERVED};
use std::ops::Range;
use std::rc::Rc;

/// Largest number of rows (pedestrians times hypotheses) that are rolled out together, if a hypothesis has no more. It
/// is enough for efficient matrix products, and bounds the memory for the hypotheses of a crowd.
const ROWS_AT_ONCE: usize = 2048;

#[derive(Clone, Copy)]
pub(super) struct PassLayers<'a> {
    pub(super) backbone: &'a dyn Backbone<KernelBackend>,
    pub(super) output: Linear,
    /// Needed for the expectation over the noise; `None` for the variants without dynamics.
    pub(super) spread: Option<NoiseSpread>,
}

pub(super) struct Pass<'a> {
    layers: PassLayers<'a>,
    backend: KernelBackend,
    batch: &'a ForecastBatch<'a>,
    observation: Observation<'a>,
    noise_width: usize,
    /// Output of the backbone's spatial encoder at the observed time steps, `[8, P, width]`.
    scene: Rc<Rows>,
}

/// The key-value caches after the observed time steps, and the features of the last one.
type Observed = (Memory<KernelBackend>, Rc<Rows>);

impl<'a> Pass<'a> {
    pub(super) fn new(
        layers: PassLayers<'a>,
        backend: KernelBackend,
        batch: &'a ForecastBatch<'a>,
        config: &'a StarConfig,
    ) -> Self {
        let observation = Observation::new(batch, config);
        let seen = observation.seen(0..OBSERVED);
        let centred = observation.centred();
        let scene = layers.backbone.scene(&backend, &centred, &seen);
        Self {
            layers,
            backend,
            batch,
            observation,
            noise_width: config.noise_width as usize,
            scene,
        }
    }

    pub(super) fn roll_out(&self) -> BatchRollout {
        let (pedestrians, hypotheses) = (self.batch.pedestrians(), self.batch.hypotheses());
        // If the inputs do not depend on the goals, the observed time steps are the same for all hypotheses.
        let shared = (self.observation.entries() == 1)
            .then(|| self.observe(&Course::new(&self.observation, self.batch, 0..1)));
        let at_once = (ROWS_AT_ONCE / pedestrians).clamp(1, hypotheses);
        let size = HORIZON * hypotheses * pedestrians;
        let mut rollout = BatchRollout {
            hypotheses,
            positions: vec![[0.0; 2]; size],
            factors: self.layers.spread.map(|_| vec![[0.0; 3]; size]),
        };
        for first in (0..hypotheses).step_by(at_once) {
            let some = first..hypotheses.min(first + at_once);
            let course = Course::new(&self.observation, self.batch, some.clone());
            let observed = match &shared {
                None => self.observe(&course),
                Some((memory, features)) => (
                    memory.repeated(&self.backend, some.len()),
                    self.backend.repeated(features, some.len()),
                ),
            };
            self.walk(course, observed, some, &mut rollout);
        }
        rollout
    }

    fn observe(&self, course: &Course<'_>) -> Observed {
        let mut memory = Memory::default();
        let mut step = |t| {
            let relative = course.observed_relative(t);
            let seen = self.observation.seen(t..t + 1);
            let scene = self.backend.entry(&self.scene, t);
            let backbone = self.layers.backbone;
            backbone.step(&self.backend, &mut memory, &relative, &scene, &seen)
        };
        for t in 0..OBSERVED - 1 {
            step(t);
        }
        let newest = step(OBSERVED - 1);
        (memory, newest)
    }

    /// Forecasts all time steps of the `hypotheses` of the course, and writes them to `rollout`.
    fn walk(
        &self,
        mut course: Course<'_>,
        (mut memory, mut features): Observed,
        hypotheses: Range<usize>,
        rollout: &mut BatchRollout,
    ) {
        let PassLayers {
            backbone, spread, ..
        } = self.layers;
        let noise = self.noise(hypotheses.clone());
        let spread = spread.filter(|_| self.batch.noise.is_none());
        let seen = self.observation.seen(OBSERVED - 1..OBSERVED);
        for t in 0..HORIZON {
            let mut emitted = self.emit(&features, &noise);
            if let Some(spread) = spread {
                let (factors, _) = emitted.as_chunks_mut::<3>();
                for factor in factors {
                    *factor = spread.expected_factor(*factor);
                }
            }
            course.advance(&mut emitted, (t, HORIZON - t));
            let first = (t * rollout.hypotheses + hypotheses.start) * self.batch.pedestrians();
            let positions = rollout.positions[first..].iter_mut();
            for (position, at) in positions.zip(course.positions()) {
                *position = at.map(f64::from);
            }
            if let Some(factors) = &mut rollout.factors {
                let (emitted, _) = emitted.as_chunks::<3>();
                for (factor, emitted) in factors[first..].iter_mut().zip(emitted) {
                    *factor = emitted.map(f64::from);
                }
            }
            if t + 1 < HORIZON {
                let centred = course.centred(OBSERVED + t + 1);
                let scene = backbone.scene(&self.backend, &centred, &seen);
                let relative = course.newest_relative();
                features = backbone.step(&self.backend, &mut memory, &relative, &scene, &seen);
            }
        }
    }

    fn emit(&self, features: &Rc<Rows>, noise: &Rc<Rows>) -> Buffer {
        let inputs = self.backend.beside(features, noise);
        Buffer::copy(&self.backend.linear(self.layers.output, &inputs))
    }

    /// The noise inputs of the output layer for some hypotheses, `[H, P, noise]`; zeros for the expectation over the
    /// noise.
    fn noise(&self, hypotheses: Range<usize>) -> Rc<Rows> {
        let width = self.noise_width;
        let shape = [hypotheses.len(), self.batch.pedestrians(), width];
        let mut numbers = Buffer::zeros(shape.iter().product());
        if let Some(draws) = &self.batch.noise {
            let entries = numbers.chunks_exact_mut(shape[1] * width);
            for (h, entry) in hypotheses.zip(entries) {
                let vector = &draws[h % self.batch.noise_vectors * width..][..width];
                for row in entry.chunks_exact_mut(width) {
                    for (number, &drawn) in row.iter_mut().zip(vector) {
                        *number = drawn as f32;
                    }
                }
            }
        }
        Rc::new(Rows::new(shape, numbers))
    }
}
