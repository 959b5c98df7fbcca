//! Work on several threads, where it is worth waking them.

use ddl_simd::{Dispatch, Kernel};
use rayon::prelude::*;

/// Multiplications (or what takes as long) below which other threads are not worth waking: some ten microseconds.
pub(super) const WORTH_WAKING: usize = 1_000_000;

/// A job, and room for what it computes that its thread keeps for the next one.
pub(super) struct Buffered<'b, J, B> {
    pub(super) job: J,
    pub(super) buffers: &'b mut B,
}

/// Does all jobs, of `work` multiplications together. A job must not depend on the thread that does it.
pub(super) fn each<J: Send, B: Default>(jobs: Vec<J>, work: usize, run: impl Fn(J, &mut B) + Sync + Send) {
    if jobs.len() < 2 || work < WORTH_WAKING || rayon::current_num_threads() == 1 {
        let mut buffers = B::default();
        for job in jobs {
            run(job, &mut buffers);
        }
    } else {
        jobs.into_par_iter()
            .for_each_init(B::default, |buffers, job| run(job, buffers));
    }
}

/// Does all jobs, each of which is a kernel.
pub(super) fn run_each<K: Kernel + Send>(dispatch: Dispatch, jobs: impl Iterator<Item = K>, work: usize) {
    each(jobs.collect(), work, |job: K, (): &mut ()| {
        dispatch.run(job);
    });
}

/// Does all jobs, each of which is a kernel with room for what it computes.
pub(super) fn run_buffered<J: Send, B: Default>(dispatch: Dispatch, jobs: Vec<J>, work: usize)
where
    for<'b> Buffered<'b, J, B>: Kernel,
{
    each(jobs, work, |job, buffers| {
        dispatch.run(Buffered { job, buffers });
    });
}
