//! Sequences in groups of sixteen, one a lane, in `f32`, scaled and shifted so that squared differences are log2 units.

use std::ops::Range;

use ddl_simd::{LANES, Lanes};

/// What a free lane holds instead of the place of a sequence.
pub(crate) const FREE: usize = usize::MAX;

/// Scaling and shifting of steps before they are rounded to `f32`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Narrowing<const D: usize> {
    /// √(log2 e / γ): squared differences are then costs in log2 units.
    pub(crate) scale: f64,
    /// Mean of all steps, subtracted before rounding: differences do not notice, the rounding error does.
    shift: [f64; D],
}

impl<const D: usize> Narrowing<D> {
    /// What suits `steps` and γ.
    pub(crate) fn new<'a>(gamma: f64, steps: impl Iterator<Item = &'a [f64; D]> + Clone) -> Self {
        let count = steps.clone().count() as f64;
        let mut shift = [0.0; D];
        for step in steps {
            for (sum, value) in shift.iter_mut().zip(step) {
                *sum += value / count;
            }
        }
        Self {
            scale: (std::f64::consts::LOG2_E / gamma).sqrt(),
            shift,
        }
    }

    /// A sequence shifted, scaled and rounded.
    pub(crate) fn narrow(&self, steps: &[[f64; D]]) -> Vec<[f32; D]> {
        steps.iter().map(|step| self.step(step)).collect()
    }

    /// Largest absolute value that `steps` have after scaling and shifting.
    pub(crate) fn largest<'a>(&self, steps: impl Iterator<Item = &'a [f64; D]>) -> f64 {
        let components = steps.flat_map(|step| step.iter().zip(&self.shift));
        components
            .map(|(v, s)| ((v - s) * self.scale).abs())
            .fold(0.0, f64::max)
    }

    pub(crate) fn step(&self, step: &[f64; D]) -> [f32; D] {
        std::array::from_fn(|d| ((step[d] - self.shift[d]) * self.scale) as f32)
    }
}

/// One step of sixteen sequences.
pub(crate) type Step<const D: usize> = [Lanes; D];

/// Sequences by length, sixteen to a block.
#[derive(Clone, Debug)]
pub(crate) struct Blocks<const D: usize> {
    pub(crate) narrowing: Narrowing<D>,
    /// Largest absolute value among the components.
    pub(crate) largest: f64,
    /// Steps of the longest sequence.
    pub(crate) longest: usize,
    /// Blocks of sequences of one length each, one after the other.
    pub(crate) runs: Vec<Run>,
    /// Which sequence is in a lane of a block, or [`FREE`].
    pub(crate) members: Vec<[usize; LANES]>,
    samples: Vec<Step<D>>,
}

/// Blocks of sequences of one length.
#[derive(Clone, Debug)]
pub(crate) struct Run {
    pub(crate) steps: usize,
    /// The blocks, as places in [`Blocks::members`].
    pub(crate) blocks: Range<usize>,
    /// First step of the first block in the samples.
    first: usize,
}

impl<const D: usize> Blocks<D> {
    /// Arranges sequences of at least one step each.
    pub(crate) fn new(gamma: f64, sequences: &[&[[f64; D]]]) -> Self {
        let steps = sequences.iter().flat_map(|sequence| sequence.iter());
        let narrowing = Narrowing::new(gamma, steps.clone());
        let mut blocks = Self {
            narrowing,
            largest: narrowing.largest(steps),
            longest: sequences.iter().map(|s| s.len()).max().unwrap_or(0),
            runs: Vec::new(),
            members: Vec::new(),
            samples: Vec::new(),
        };
        let mut order: Vec<usize> = (0..sequences.len()).collect();
        order.sort_by_key(|&i| sequences[i].len());
        for run in order.chunk_by(|&a, &b| sequences[a].len() == sequences[b].len()) {
            let (first, first_block) = (blocks.samples.len(), blocks.members.len());
            for members in run.chunks(LANES) {
                blocks.push(sequences, members);
            }
            blocks.runs.push(Run {
                steps: sequences[run[0]].len(),
                blocks: first_block..blocks.members.len(),
                first,
            });
        }
        blocks
    }

    fn push(&mut self, sequences: &[&[[f64; D]]], members: &[usize]) {
        let first = self.samples.len();
        let steps = sequences[members[0]].len();
        self.samples.resize(first + steps, [Lanes::ZERO; D]);
        let mut lanes = [FREE; LANES];
        for (lane, &member) in members.iter().enumerate() {
            lanes[lane] = member;
            for (step, sample) in sequences[member].iter().zip(&mut self.samples[first..]) {
                for (lanes, value) in sample.iter_mut().zip(self.narrowing.step(step)) {
                    lanes.0[lane] = value;
                }
            }
        }
        self.members.push(lanes);
    }

    /// The steps of `blocks` (places in [`Blocks::members`]) of a run, one block after the other.
    pub(crate) fn samples(&self, run: &Run, blocks: &Range<usize>) -> &[Step<D>] {
        let step = |block: usize| run.first + (block - run.blocks.start) * run.steps;
        &self.samples[step(blocks.start)..step(blocks.end)]
    }
}

#[cfg(test)]
mod tests {
    use super::{Blocks, FREE};

    #[test]
    fn every_sequence_has_one_lane_and_lengths_do_not_mix() {
        let sequences: Vec<Vec<[f64; 1]>> = (0..45)
            .map(|i| vec![[f64::from(i)]; 1 + i as usize % 2])
            .collect();
        let slices: Vec<&[[f64; 1]]> = sequences.iter().map(Vec::as_slice).collect();
        let gamma = std::f64::consts::LOG2_E; // costs are then log2 units as they are
        let blocks = Blocks::new(gamma, &slices);
        assert_eq!(
            (blocks.longest, blocks.runs.len(), blocks.members.len()),
            (2, 2, 4)
        );
        let mut seen = [false; 45];
        let first = blocks.samples(&blocks.runs[0], &(0..1))[0][0].0[0];
        for run in &blocks.runs {
            for block in run.blocks.clone() {
                let samples = blocks.samples(run, &(block..block + 1));
                assert_eq!(samples.len(), run.steps);
                for (lane, &member) in blocks.members[block].iter().enumerate() {
                    if member == FREE {
                        continue;
                    }
                    assert!(!std::mem::replace(&mut seen[member], true));
                    assert_eq!(sequences[member].len(), run.steps);
                    // Sequence 0 is in the first lane, and differences survive the shift.
                    assert!((samples[0][0].0[lane] - first - member as f32).abs() < 1e-5);
                }
            }
        }
        assert!(seen.iter().all(|&seen| seen));
    }
}
