//! Work on several threads, if there is enough of it.

use ddl_simd::{Dispatch, Kernel};
use rayon::prelude::*;
use std::cell::Cell;
use std::thread::LocalKey;

/// Number of multiplications below which other threads are not woken: less than some tens of microseconds of work.
pub(super) const WORTH_WAKING: usize = 1_000_000;

/// A job, with a buffer for its results that the thread reuses for the next job.
pub(super) struct Buffered<'b, J, B> {
    pub(super) job: J,
    pub(super) buffers: &'b mut B,
}

/// The buffers of a job. Each thread keeps those of small work, because allocating them would take as long as the work.
pub(super) trait JobBuffers: Default + 'static {
    fn of_thread() -> &'static LocalKey<Cell<Self>>;
}

impl JobBuffers for () {
    fn of_thread() -> &'static LocalKey<Cell<()>> {
        thread_local!(static BUFFERS: Cell<()> = const { Cell::new(()) });
        &BUFFERS
    }
}

/// Runs all jobs, of `work` multiplications together. The result of a job must not depend on its thread.
pub(super) fn run_jobs<J: Send, B: JobBuffers>(jobs: Vec<J>, work: usize, run: impl Fn(J, &mut B) + Sync + Send) {
    let (small, of_thread) = (work < WORTH_WAKING, B::of_thread());
    if jobs.len() < 2 || small || rayon::current_num_threads() == 1 {
        let mut buffers = if small { of_thread.take() } else { B::default() };
        for job in jobs {
            run(job, &mut buffers);
        }
        if small {
            of_thread.set(buffers);
        }
    } else {
        jobs.into_par_iter()
            .for_each_init(B::default, |buffers, job| run(job, buffers));
    }
}

/// Runs all jobs, each of which is a kernel.
pub(super) fn run_each<K: Kernel + Send>(dispatch: Dispatch, jobs: impl Iterator<Item = K>, work: usize) {
    run_jobs(jobs.collect(), work, |job: K, (): &mut ()| {
        dispatch.run(job);
    });
}

/// Runs all jobs, each of which is a kernel with a buffer for its results.
pub(super) fn run_buffered<J: Send, B: JobBuffers>(dispatch: Dispatch, jobs: Vec<J>, work: usize)
where
    for<'b> Buffered<'b, J, B>: Kernel,
{
    run_jobs(jobs, work, |job, buffers| {
        dispatch.run(Buffered { job, buffers });
    });
}
