//! Sequences in groups of sixteen, one per lane, in `f32`. They are scaled and shifted so that squared differences are
//! in log2 units.

use ddl_simd::{LANES, Lanes};
use std::ops::Range;

/// Marks a free lane, in place of the index of a sequence.
pub(crate) const FREE: usize = usize::MAX;

/// Scaling and shifting of steps before they are rounded to `f32`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Narrowing<const D: usize> {
    /// √(log2 e / γ): squared differences are then costs in log2 units.
    pub(crate) scale: f64,
    /// Mean of all steps. It is subtracted before rounding, which leaves differences unchanged and reduces the rounding
    /// error.
    shift: [f64; D],
}

impl<const D: usize> Narrowing<D> {
    pub(crate) fn new<'a>(gamma: f64, steps: impl Iterator<Item = &'a [f64; D]> + Clone) -> Self {
        let count = steps.clone().count() as f64;
        let mut shift = [0.0; D];
        for step in steps {
            for (sum, value) in shift.iter_mut().zip(step) {
                *sum += value / count;
            }
        }
        Self { scale: (std::f64::consts::LOG2_E / gamma).sqrt(), shift }
    }

    pub(crate) fn narrow(&self, steps: &[[f64; D]]) -> Vec<[f32; D]> {
        steps.iter().map(|step| self.step(step)).collect()
    }

    /// Largest absolute value that `steps` have after scaling and shifting.
    pub(crate) fn largest<'a>(&self, steps: impl Iterator<Item = &'a [f64; D]>) -> f64 {
        let components = steps.flat_map(|step| step.iter().zip(&self.shift));
        components.map(|(v, s)| ((v - s) * self.scale).abs()).fold(0.0, f64::max)
    }

    pub(crate) fn step(&self, step: &[f64; D]) -> [f32; D] {
        std::array::from_fn(|d| ((step[d] - self.shift[d]) * self.scale) as f32)
    }
}

pub(crate) type BlockStep<const D: usize> = [Lanes; D];

/// Sequences by length, sixteen to a block.
#[derive(Clone, Debug)]
pub(crate) struct Blocks<const D: usize> {
    pub(crate) narrowing: Narrowing<D>,
    pub(crate) largest: f64,
    pub(crate) longest: usize,
    /// Blocks of sequences of one length each, one after the other.
    pub(crate) runs: Vec<BlockRun>,
    /// The index of the sequence in each lane of each block, or [`FREE`].
    pub(crate) members: Vec<[usize; LANES]>,
    samples: Vec<BlockStep<D>>,
}

#[derive(Clone, Debug)]
pub(crate) struct BlockRun {
    pub(crate) steps: usize,
    /// The blocks, as a range of indices into [`Blocks::members`].
    pub(crate) blocks: Range<usize>,
    first: usize,
}

impl<const D: usize> Blocks<D> {
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
            blocks.runs.push(BlockRun {
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

    /// The steps of a run, block by block.
    pub(crate) fn samples(&self, run: &BlockRun) -> &[BlockStep<D>] {
        &self.samples[run.first..][..run.blocks.len() * run.steps]
    }
}
