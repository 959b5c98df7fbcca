//! Work on several threads, if there is enough of it.

use ddl_simd::{Dispatch, Kernel};
use rayon::prelude::*;

/// Number of multiplications below which other threads are not woken: less than some tens of microseconds of work.
pub(super) const WORTH_WAKING: usize = 1_000_000;

/// Runs all jobs, of `work` multiplications together. The result of a job must not depend on its thread.
pub(super) fn run_jobs<J: Send>(jobs: Vec<J>, work: usize, run: impl Fn(J) + Sync + Send) {
    if jobs.len() < 2 || work < WORTH_WAKING || rayon::current_num_threads() == 1 {
        jobs.into_iter().for_each(run);
    } else {
        jobs.into_par_iter().for_each(run);
    }
}

/// Runs all jobs, each of which is a kernel.
pub(super) fn run_each<K: Kernel + Send>(dispatch: Dispatch, jobs: impl Iterator<Item = K>, work: usize) {
    run_jobs(jobs.collect(), work, |job| {
        dispatch.run(job);
    });
}
