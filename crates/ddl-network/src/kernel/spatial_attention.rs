//! Spatial attention: each pedestrian attends to the visible pedestrians of its scene (Vaswani et al. 2017, section
//! 3.2).

mod backward;
mod dropout;
mod forward;
mod queries;
#[cfg(test)]
mod tests;

use crate::kernel::buffer::Buffer;
use crate::kernel::dropout::Dropout;
use crate::kernel::heads::AttentionKernel;
use crate::kernel::scenes::SceneFrames;
use backward::SceneBackward;
use ddl_simd::Lanes;
use dropout::WeightDecisions;
use forward::SceneForward;
pub(super) use queries::prepare_thread;
use queries::{SceneTask, run_buffered};

/// Cost of a pair of a query and a key, in multiplications.
const WORK_OF_A_PAIR: usize = 50;

/// The output of an attention, and what the backward pass of [`AttentionKernel::spatial_forward`] needs in addition.
#[derive(Clone, Debug)]
pub(crate) struct Attended {
    /// Mixed values, `[B, P, heads, head width]`.
    pub(crate) mixed: Buffer,
    /// For each entry, scene, pair of queries and group of heads: the largest score (log2 units), and 1 / Σ 2^(score −
    /// largest). Empty without `keep`.
    pub(crate) normalisers: Vec<[Lanes; 2]>,
}

impl AttentionKernel {
    /// Mixes the values of the visible pedestrians. For each head, `mixed_i = Σ_j d_ij softmax_j(q_i · k_j / √head
    /// width) v_j` over the j that are visible to i. `d_ij` is the factor of [`Dropout`], or 1 without it.
    ///
    /// `inputs`: queries, keys and values, `[B, P, heads, head width]` each, with all pedestrians P of the scenes; 1 or
    /// B `frames`.
    /// [`spatial_backward`](Self::spatial_backward) panics if the result was made without `keep`.
    pub(crate) fn spatial_forward(
        &self,
        inputs: [&[f32]; 3],
        frames: SceneFrames<'_>,
        dropout: Option<Dropout>,
        keep: bool,
    ) -> Attended {
        let entries = self.check_scenes(inputs, frames);
        let rows = entries * frames.scenes().pedestrians();
        let row = self.heads.row();
        let normalisers = if keep { entries * self.normalisers(frames) } else { 0 };
        let mut attended =
            Attended { mixed: Buffer::any(rows * row), normalisers: vec![[Lanes::ZERO; 2]; normalisers] };
        let (mut mixed, mut normalisers) = (&mut attended.mixed[..], &mut attended.normalisers[..]);
        let mut jobs = Vec::new();
        let groups = self.heads.groups();
        for (inputs, task) in self.tasks(inputs, frames, dropout) {
            jobs.extend(task.blocks().map(|task| SceneForward {
                inputs,
                mixed: mixed.split_off_mut(..task.queries().len() * row).unwrap_or_default(),
                normalisers: normalisers.split_off_mut(..task.twos.len() * groups).unwrap_or_default(),
                task,
            }));
        }
        let work = self.work(frames, entries);
        run_buffered(self.dispatch, jobs, work);
        attended
    }

    /// The gradient of the inputs of [`AttentionKernel::spatial_forward`] from that of its output.
    /// `mixed_gradient` `[B, P, heads, head width]` -> `gradients` of the shapes of the inputs, overwritten.
    /// The first four arguments must be those of a forward pass with `keep`.
    pub(crate) fn spatial_backward(
        &self,
        inputs: [&[f32]; 3],
        frames: SceneFrames<'_>,
        dropout: Option<Dropout>,
        attended: &Attended,
        mixed_gradient: &[f32],
        mut gradients: [&mut [f32]; 3],
    ) {
        let entries = self.check_scenes(inputs, frames);
        let rows = entries * frames.scenes().pedestrians();
        let row = self.heads.row();
        let normalisers = entries * self.normalisers(frames);
        assert_eq!(attended.mixed.len(), rows * row, "mixed");
        assert_eq!(attended.normalisers.len(), normalisers, "normalisers");
        assert_eq!(mixed_gradient.len(), rows * row, "gradient of mixed");
        for gradient in &gradients {
            assert_eq!(gradient.len(), rows * row, "gradient of an input");
        }
        let (mut mixed, mut normalisers) = (&attended.mixed[..], &attended.normalisers[..]);
        let mut mixed_gradient = mixed_gradient;
        let mut jobs = Vec::new();
        for (inputs, task) in self.tasks(inputs, frames, dropout) {
            let numbers = task.scene.pedestrians * row;
            jobs.push(SceneBackward {
                inputs,
                mixed: mixed.split_off(..numbers).unwrap_or_default(),
                normalisers: normalisers.split_off(..task.twos.len() * self.heads.groups()).unwrap_or_default(),
                mixed_gradient: mixed_gradient.split_off(..numbers).unwrap_or_default(),
                gradients: gradients.each_mut().map(|gradient| gradient.split_off_mut(..numbers).unwrap_or_default()),
                task,
            });
        }
        run_buffered(self.dispatch, jobs, self.work(frames, entries));
    }

    fn work(&self, frames: SceneFrames<'_>, entries: usize) -> usize {
        frames.pairs(entries) * self.heads.groups() * WORK_OF_A_PAIR
    }

    fn normalisers(&self, frames: SceneFrames<'_>) -> usize {
        let ranges = frames.scenes().ranges().iter();
        self.heads.groups() * ranges.map(|range| range.len().div_ceil(2)).sum::<usize>()
    }

    fn check_scenes(&self, inputs: [&[f32]; 3], frames: SceneFrames<'_>) -> usize {
        let entry = frames.scenes().pedestrians() * self.heads.row();
        for input in inputs {
            let whole = !input.is_empty() && input.len().is_multiple_of(entry) && input.len() == inputs[0].len();
            assert!(whole, "an input has {} numbers, not entries of {entry}", input.len());
        }
        let entries = inputs[0].len() / entry;
        frames.check(entries);
        entries
    }

    /// All scenes of all entries with their parts of the inputs, in the order of the rows.
    fn tasks<'a>(
        &self,
        inputs: [&'a [f32]; 3],
        frames: SceneFrames<'a>,
        dropout: Option<Dropout>,
    ) -> impl Iterator<Item = ([&'a [f32]; 3], SceneTask<'a>)> {
        let (heads, decisions) = (self.heads, dropout.and_then(WeightDecisions::new));
        let row = heads.row();
        let numbers = frames.scenes().pedestrians() * row;
        (0..inputs[0].len() / numbers).flat_map(move |entry| {
            frames.of_entry(entry).map(move |scene| {
                let task = SceneTask {
                    scene,
                    twos: 0..scene.pedestrians.div_ceil(2),
                    keys: 0..scene.pedestrians,
                    entry,
                    decisions,
                    heads,
                };
                let first = entry * numbers + scene.first * row;
                (inputs.map(|input| &input[first..][..scene.pedestrians * row]), task)
            })
        })
    }
}
