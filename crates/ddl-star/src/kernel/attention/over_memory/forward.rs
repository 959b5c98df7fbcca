//! From queries, keys and values to mixed values.

#![expect(clippy::inline_always, reason = "the lanes must stay in registers")]

use super::KeyValue;
use super::tokens::{Buffers, Place, accumulate, soften, weighted};
use crate::kernel::attention::heads::Heads;
use crate::kernel::attention::instruction_set::Kernel;
use crate::kernel::attention::lanes::{DEPTH, LANES, Lanes, scaled};

/// Some of the rows.
#[derive(Debug)]
pub(super) struct Forward<'a> {
    pub(super) heads: Heads,
    /// Where the rows start in the whole.
    pub(super) first: usize,
    pub(super) query: &'a [f32],
    pub(super) memory: &'a [KeyValue<'a>],
    pub(super) own: KeyValue<'a>,
    /// Of these rows alone.
    pub(super) mixed: &'a mut [f32],
}

#[derive(Debug)]
pub(super) struct Run<'a, 'b> {
    pub(super) job: Forward<'a>,
    pub(super) buffers: &'b mut Buffers,
}

impl Kernel for Run<'_, '_> {
    #[inline(always)]
    fn run<const FUSED: bool>(self) {
        // The usual width is spelled out, which takes the loops over blocks away.
        match self.job.heads.width {
            DEPTH => self.rows::<FUSED>(DEPTH, 1),
            width => {
                let blocks = self.job.heads.blocks();
                self.rows::<FUSED>(width, blocks);
            }
        }
    }
}

impl Run<'_, '_> {
    #[inline(always)]
    fn rows<const FUSED: bool>(self, width: usize, blocks: usize) {
        let Self { job, buffers } = self;
        let scale = Lanes::splat(job.heads.scale() * std::f32::consts::LOG2_E);
        let length = job.mixed.len();
        let groups = job.mixed.chunks_mut(LANES * width).enumerate();
        for (group, mixed) in groups {
            let place = Place::new(job.first, group * LANES * width, length, width);
            buffers.query.clear();
            for block in 0..blocks {
                let query = place.load(job.query, block);
                buffers.query.push(scaled(&query, scale));
            }
            let powers = &mut buffers.powers;
            let share = soften::<FUSED>(place, &buffers.query, job.memory, job.own, powers);
            for block in 0..blocks {
                let mut sum = [Lanes::ZERO; DEPTH];
                let tokens = job.memory.iter().chain([&job.own]);
                for (power, token) in powers.iter().zip(tokens) {
                    accumulate::<FUSED>(&mut sum, *power, &place.load(token.value, block));
                }
                place.store(&weighted(share, &sum), mixed, block);
            }
        }
    }
}
