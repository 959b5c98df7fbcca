//! Runs work on a thread pool without holding the GIL. Ctrl-C ends the call; a forked child gets its own pool.

use crate::errors::{ensure, of_any};
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use rayon::ThreadPool;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

/// Interval between two checks for Ctrl-C.
const PAUSE: Duration = Duration::from_millis(50);

struct Pool {
    /// The threads of a pool do not exist in a forked child, which makes its own.
    process: u32,
    count: usize,
    threads: Arc<ThreadPool>,
}

/// The pool to compute on. A rayon worker that waits for a part of its work runs other jobs of its pool. So live frames
/// have their own pool, in which they do not wait for a long call of another thread.
#[derive(Debug, Clone, Copy)]
pub(crate) enum User {
    Calls,
    Live,
}

static POOLS: [Mutex<Option<Pool>>; 2] = [Mutex::new(None), Mutex::new(None)];

/// Signals to the work that its call was interrupted.
#[derive(Debug, Clone, Default)]
pub(crate) struct Stop(Arc<AtomicBool>);

impl Stop {
    pub(crate) fn is_asked(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }
}

/// Runs the work on the pool for calls, without the GIL. Ctrl-C ends the call within 50 ms. The work should check its
/// argument and stop.
pub(crate) fn run<T: Send + 'static>(py: Python<'_>, work: impl FnOnce(&Stop) -> T + Send + 'static) -> PyResult<T> {
    run_on(User::Calls, py, work, |_| Ok(()))
}

/// As [`run`], on another pool and with progress: `tell` is called with the GIL every 50 ms, and may end the call with
/// an exception.
pub(crate) fn run_on<T: Send + 'static>(
    user: User,
    py: Python<'_>,
    work: impl FnOnce(&Stop) -> T + Send + 'static,
    mut tell: impl FnMut(Python<'_>) -> PyResult<()>,
) -> PyResult<T> {
    let pool = pool(user, None)?;
    let (sender, mut receiver) = channel();
    let stop = Stop::default();
    let seen = stop.clone();
    pool.spawn(move || {
        let done = catch_unwind(AssertUnwindSafe(|| work(&seen)));
        // After Ctrl-C the receiver is dropped, and the result is not needed.
        let _ = sender.send(done);
    });
    loop {
        let (waited, same) = py.detach(move || (receiver.recv_timeout(PAUSE), receiver));
        receiver = same;
        match waited {
            Ok(Ok(done)) => return Ok(done),
            Ok(Err(panic)) => resume_unwind(panic),
            Err(RecvTimeoutError::Timeout) => {
                if let Err(signal) = py.check_signals().and_then(|()| tell(py)) {
                    stop.0.store(true, Ordering::Relaxed);
                    return Err(signal);
                }
            }
            Err(RecvTimeoutError::Disconnected) => {
                let message = "a thread of ddl_forecast has ended unexpectedly";
                return Err(PyRuntimeError::new_err(message));
            }
        }
    }
}

/// The pool of this process, replaced if the number of threads has changed.
fn pool(user: User, threads: Option<usize>) -> PyResult<Arc<ThreadPool>> {
    let mut held = POOLS[user as usize].lock().unwrap_or_else(PoisonError::into_inner);
    let process = std::process::id();
    let wanted = threads.or(held.as_ref().map(|held| held.count));
    if let Some(held) = &*held
        && held.process == process
        && wanted == Some(held.count)
    {
        return Ok(Arc::clone(&held.threads));
    }
    // 0: the number of cores, or the environment variable RAYON_NUM_THREADS.
    let threads = wanted.unwrap_or(0);
    let pool = Arc::new(ddl::thread_pool(threads).map_err(of_any)?);
    let old = held.replace(Pool { process, count: threads, threads: Arc::clone(&pool) });
    if let Some(old) = old.filter(|old| old.process != process) {
        // Its threads exist only in the parent: there is nothing to join.
        std::mem::forget(old);
    }
    Ok(pool)
}

/// Waits without the GIL until `attempt` returns a value; Ctrl-C ends the wait.
pub(crate) fn wait_for<T>(py: Python<'_>, mut attempt: impl FnMut() -> Option<T>) -> PyResult<T> {
    loop {
        if let Some(value) = attempt() {
            return Ok(value);
        }
        py.detach(|| std::thread::sleep(Duration::from_millis(1)));
        py.check_signals()?;
    }
}

#[pyfunction]
pub(crate) fn set_num_threads(threads: usize) -> PyResult<()> {
    ensure!(threads > 0, "threads must be at least 1, found 0");
    pool(User::Live, Some(threads))?;
    pool(User::Calls, Some(threads)).map(drop)
}
