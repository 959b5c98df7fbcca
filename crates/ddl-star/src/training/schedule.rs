//! Assigns windows to batches, orders the batches, and draws their rotations.

use ddl_core::{Rotation, Window};
use ddl_network::TrainingConfig;
use ddl_network::seed::{Stage, stream};
use rand::RngExt as _;
use std::f64::consts::PI;

/// Batches of window indices, visited repeatedly in a fixed order (as published: windows are shuffled once).
#[derive(Debug)]
pub(crate) struct Schedule {
    pub(crate) batches: Vec<Vec<usize>>,
    pub(crate) steps_per_epoch: usize,
    pub(crate) seed: u64,
}

impl Schedule {
    /// Shuffles the windows and groups them into batches of more than `batch_pedestrians` pedestrians. An incomplete
    /// last batch is dropped unless it is the only one.
    pub(crate) fn new(windows: &[Window], config: &TrainingConfig) -> Self {
        let mut order: Vec<usize> = (0..windows.len()).collect();
        let mut rng = stream(config.seed, Stage::BatchOrder, 0);
        for last in (1..order.len()).rev() {
            order.swap(last, rng.random_range(0..=last));
        }
        let mut batches = Vec::new();
        let (mut batch, mut pedestrians) = (Vec::new(), 0);
        for index in order {
            batch.push(index);
            pedestrians += windows[index].len();
            if pedestrians > config.batch_pedestrians {
                batches.push(std::mem::take(&mut batch));
                pedestrians = 0;
            }
        }
        if batches.is_empty() && !batch.is_empty() {
            batches.push(batch);
        }
        let steps_per_epoch = config.pedestrians_per_epoch.map_or(batches.len(), |pedestrians| {
            pedestrians.div_ceil(config.batch_pedestrians).clamp(1, batches.len().max(1))
        });
        Self { batches, steps_per_epoch, seed: config.seed }
    }

    pub(crate) fn batch_index(&self, step: u64) -> usize {
        (step % self.batches.len() as u64) as usize
    }

    /// The rotation of the batch of a step: the sum over its visits of one angle in [0, pi) for each visit.
    pub(crate) fn rotation(&self, step: u64) -> Rotation {
        let batches = self.batches.len() as u64;
        let (visit, index) = (step / batches, step % batches);
        let angle: f64 = (0..=visit)
            .map(|visit| {
                let mut rng = stream(self.seed, Stage::Rotation, visit * batches + index);
                PI * rng.random::<f64>()
            })
            .sum();
        Rotation::new(angle)
    }
}
