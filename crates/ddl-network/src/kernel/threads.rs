//! Work on several threads, where it is worth waking them.

use rayon::prelude::*;

/// Multiplications (or what takes as long) below which other threads are not worth waking: some ten microseconds.
pub(super) const WORTH_WAKING: usize = 1_000_000;

/// A job, and room for what it computes that its thread keeps for the next one.
#[derive(Debug)]
pub(super) struct Buffered<'b, J, B> {
    pub(super) job: J,
    pub(super) buffers: &'b mut B,
}

/// Does all jobs, of `work` multiplications together. A job must not depend on the thread that does it.
pub(super) fn each<J: Send, B: Default>(
    jobs: Vec<J>,
    work: usize,
    run: impl Fn(J, &mut B) + Sync + Send,
) {
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
