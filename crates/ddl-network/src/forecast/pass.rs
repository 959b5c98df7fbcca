//! The rollout of one batch of windows, some hypotheses at a time.

use crate::backend::{Backend as _, Buffer, KernelBackend, Memory, Rows};
use crate::forecast::batch::{BatchRollout, ForecastBatch};
use crate::forecast::forecast_windows::ForecastWindows;
use crate::forecast::network::MotionNetwork;
use crate::forecast::rollout_state::{ObservedSteps, RolloutState};
use crate::kernel::KeepBuffers;
use crate::weights::Weights;
use crate::{NetworkError, StarConfig};
use ddl_core::{HORIZON, OBSERVED};
use rayon::prelude::*;
use std::ops::Range;
use std::rc::Rc;
use std::sync::Arc;

/// Pedestrians times hypotheses that are rolled out together: enough to fill the products, and so few that the
/// key-value caches of all time steps stay in the processor's cache. Threads take such parts in turns.
const ROWS_AT_ONCE: usize = 128;

/// The data that all hypotheses of a batch share.
struct Pass<'a> {
    network: &'a MotionNetwork,
    batch: &'a ForecastBatch<'a>,
    observation: ObservedSteps<'a>,
    /// Output of the backbone's spatial encoder at the observed time steps, `[8, P, width]`.
    scene: Buffer,
}

/// The key-value caches after the observed time steps, and the features of the last one.
type ObservedMemory = (Memory<KernelBackend>, Rc<Rows>);

/// Some hypotheses of a pass, rolled out on one thread.
struct HypothesisPart<'a> {
    pass: &'a Pass<'a>,
    backend: KernelBackend,
    hypotheses: Range<usize>,
}

impl ForecastWindows for MotionNetwork {
    fn config(&self) -> &StarConfig {
        &self.config
    }

    fn copy_weights(&self) -> Result<Weights, NetworkError> {
        Ok(self.weights.clone())
    }

    fn roll_out(&self, batch: &ForecastBatch<'_>) -> Result<BatchRollout, NetworkError> {
        Ok(Pass::new(self, batch).roll_out())
    }
}

impl<'a> Pass<'a> {
    fn new(network: &'a MotionNetwork, batch: &'a ForecastBatch<'a>) -> Self {
        let observation = ObservedSteps::new(batch, &network.config);
        let seen = observation.seen(0..OBSERVED);
        let centred = observation.centred();
        let backend = KernelBackend::forward_only(Arc::clone(&network.kernels));
        let scene = network.backbone.scene(&backend, &centred, &seen);
        Self { scene: Buffer::copy(&scene), network, batch, observation }
    }

    fn roll_out(&self) -> BatchRollout {
        let (pedestrians, hypotheses) = (self.batch.pedestrians(), self.batch.hypotheses());
        let at_once = (ROWS_AT_ONCE / pedestrians).clamp(1, hypotheses);
        let parts: Vec<BatchRollout> = (0..hypotheses)
            .step_by(at_once)
            .collect::<Vec<usize>>()
            .into_par_iter()
            .map_init(KeepBuffers::new, |_, first| {
                let part = HypothesisPart {
                    pass: self,
                    backend: KernelBackend::forward_only(Arc::clone(&self.network.kernels)),
                    hypotheses: first..hypotheses.min(first + at_once),
                };
                part.roll_out()
            })
            .collect();
        joined(&parts, pedestrians)
    }
}

/// The hypotheses of all parts, in their order.
fn joined(parts: &[BatchRollout], pedestrians: usize) -> BatchRollout {
    fn steps<T: Copy>(parts: &[BatchRollout], pedestrians: usize, numbers: impl Fn(&BatchRollout) -> &[T]) -> Vec<T> {
        let mut numbers_of_steps = Vec::with_capacity(parts.iter().map(|part| numbers(part).len()).sum());
        for t in 0..HORIZON {
            for part in parts {
                let count = part.hypotheses * pedestrians;
                numbers_of_steps.extend_from_slice(&numbers(part)[t * count..][..count]);
            }
        }
        numbers_of_steps
    }
    let with_factors = parts.iter().all(|part| part.factors.is_some());
    BatchRollout {
        hypotheses: parts.iter().map(|part| part.hypotheses).sum(),
        positions: steps(parts, pedestrians, |part| &part.positions),
        factors: with_factors.then(|| steps(parts, pedestrians, |part| part.factors.as_deref().unwrap_or(&[]))),
    }
}

impl HypothesisPart<'_> {
    fn roll_out(&self) -> BatchRollout {
        let Pass { observation, batch, .. } = self.pass;
        // If goals are not an input, the observed time steps are the same for all hypotheses.
        let count = self.hypotheses.len();
        let shared = observation.entries == 1 && count > 1;
        let state = RolloutState::new(observation, batch, self.hypotheses.clone());
        let observed = if shared {
            let (memory, features) = self.observe(&RolloutState::new(observation, batch, 0..1));
            (memory.repeated(&self.backend, count), self.backend.repeated(&features, count))
        } else {
            self.observe(&state)
        };
        self.walk(state, observed)
    }

    fn observe(&self, state: &RolloutState<'_>) -> ObservedMemory {
        let mut memory = Memory::default();
        let mut step = |t| {
            let relative = state.observed_relative(t);
            let seen = self.pass.observation.seen(t..t + 1);
            let scene = self.scene(t);
            let backbone = &self.pass.network.backbone;
            backbone.step(&self.backend, &mut memory, &relative, &scene, &seen)
        };
        for t in 0..OBSERVED - 1 {
            step(t);
        }
        let newest = step(OBSERVED - 1);
        (memory, newest)
    }

    /// Computes the time steps to forecast.
    fn walk(&self, mut state: RolloutState<'_>, (mut memory, mut features): ObservedMemory) -> BatchRollout {
        let Pass { observation, batch, .. } = self.pass;
        let MotionNetwork { backbone, spread, .. } = self.pass.network;
        let hypotheses = self.hypotheses.len();
        let size = HORIZON * hypotheses * batch.pedestrians();
        let mut positions = Vec::with_capacity(size);
        let mut of_factors = spread.map(|_| Vec::with_capacity(size));
        let noise = self.noise();
        let spread = spread.filter(|_| batch.noise.is_none());
        let seen = observation.seen(OBSERVED - 1..OBSERVED);
        for t in 0..HORIZON {
            let mut emitted = self.emit(&features, &noise);
            if let Some(spread) = spread {
                let (factors, _) = emitted.as_chunks_mut::<3>();
                for factor in factors {
                    *factor = spread.expected_factor(*factor);
                }
            }
            state.advance(&mut emitted, (t, HORIZON - t));
            positions.extend(state.positions.iter().map(|position| position.map(f64::from)));
            if let Some(factors) = &mut of_factors {
                let (emitted, _) = emitted.as_chunks::<3>();
                factors.extend(emitted.iter().map(|factor| factor.map(f64::from)));
            }
            if t + 1 < HORIZON {
                let centred = state.centred(OBSERVED + t + 1);
                let scene = backbone.scene(&self.backend, &centred, &seen);
                let relative = state.relative(&state.positions, &state.before);
                features = backbone.step(&self.backend, &mut memory, &relative, &scene, &seen);
            }
        }
        BatchRollout { hypotheses, positions, factors: of_factors }
    }

    /// The scene at observed time step `t`, `[1, P, width]`.
    fn scene(&self, t: usize) -> Rc<Rows> {
        let pedestrians = self.pass.batch.pedestrians();
        let width = self.pass.scene.len() / (OBSERVED * pedestrians);
        let count = pedestrians * width;
        let numbers = Buffer::copy(&self.pass.scene[t * count..][..count]);
        Rc::new(Rows::new([1, pedestrians, width], numbers))
    }

    fn emit(&self, features: &Rc<Rows>, noise: &Rc<Rows>) -> Buffer {
        let inputs = self.backend.concatenate(features, noise);
        Buffer::copy(&self.backend.linear(self.pass.network.output, &inputs))
    }

    /// The noise input of each pedestrian, `[H, P, noise]`; zeros if the expectation is added afterwards.
    fn noise(&self) -> Rc<Rows> {
        let (width, batch) = (self.pass.network.config.noise_width as usize, self.pass.batch);
        let hypotheses = self.hypotheses.clone();
        let shape = [hypotheses.len(), batch.pedestrians(), width];
        let mut numbers = Buffer::zeros(shape.iter().product());
        if let Some(draws) = &batch.noise {
            let entries = numbers.chunks_exact_mut(shape[1] * width);
            for (h, entry) in hypotheses.zip(entries) {
                let vector = &draws[h % batch.noise_vectors * width..][..width];
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
