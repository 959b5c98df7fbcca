//! A loaded model, and the threads that it computes on.

use crate::boundary::CallFailure;
use ddl::data::Window;
use ddl::{Answer, Ddl, DeviceChoice, ModelSource, Request};
use rayon::{ThreadPool, ThreadPoolBuilder};
use std::path::Path;
use std::sync::Arc;

#[derive(Debug)]
pub(crate) struct LoadedModel {
    pub(crate) ddl: Arc<Ddl>,
    pub(crate) threads: Arc<Threads>,
}

impl LoadedModel {
    /// The built-in model of that name, or the model at that path.
    pub(crate) fn open(name: &str, threads: usize) -> Result<Self, CallFailure> {
        // The fields of `ddl.h`.
        ddl::word_settings(|name, _| format!("`{}`", if name == "fps" { "rate" } else { name }));
        let threads = Arc::new(Threads::new(threads)?);
        let source = ModelSource::named(Path::new(name));
        let ddl = threads.run(|| Ddl::open(&source, DeviceChoice::Cpu).map_err(CallFailure::file))?;
        Ok(Self { ddl: Arc::new(ddl), threads })
    }

    pub(crate) fn forecast(&self, window: &Window, request: &Request) -> Result<Answer, CallFailure> {
        let forecast = || self.ddl.forecast(std::slice::from_ref(window), request).map_err(CallFailure::invalid);
        Ok(self.threads.run(forecast)?.remove(0))
    }
}

/// Where a model computes.
#[derive(Debug)]
pub(crate) enum Threads {
    /// On the thread that calls, with its priority and its processor.
    Calling,
    Own(ThreadPool),
}

impl Threads {
    /// So many; 0 for one on each core.
    fn new(count: usize) -> Result<Self, CallFailure> {
        if count == 1 {
            return Ok(Self::Calling);
        }
        ddl::thread_pool(count).map(Self::Own).map_err(CallFailure::invalid)
    }

    pub(crate) fn run<T: Send>(&self, work: impl FnOnce() -> Result<T, CallFailure> + Send) -> Result<T, CallFailure> {
        if let Self::Own(pool) = self {
            return pool.install(work);
        }
        // Outside of a pool, rayon would start one with a thread on each core.
        if rayon::current_thread_index().is_none() {
            let alone = ThreadPoolBuilder::new().num_threads(1).use_current_thread().build();
            // It belongs to this thread for as long as that lives.
            std::mem::forget(alone.map_err(CallFailure::invalid)?);
        }
        work()
    }
}
