//! Ctrl-C as a request to stop, which is checked between two steps of the work.

use std::ops::ControlFlow;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::{Duration, Instant};

/// Signals in such quick succession are one request. A job manager may signal all processes of a job, and the parent
/// passes the signal on to this one.
const ONE_REQUEST: Duration = Duration::from_millis(300);

#[derive(Debug, Clone, Default)]
pub(crate) struct Interrupt(Arc<AtomicUsize>);

impl Interrupt {
    /// Catches Ctrl-C (SIGINT) and SIGTERM; a second signal ends the program at once.
    pub(crate) fn catch() -> anyhow::Result<Self> {
        Self::catch_until(2, |_| {})
    }

    /// Catches Ctrl-C (SIGINT) and SIGTERM, and calls back with the number of each request; request `last` ends the
    /// program at once.
    pub(crate) fn catch_until(last: usize, hear: impl Fn(usize) + Send + 'static) -> anyhow::Result<Self> {
        let interrupt = Self::default();
        let seen = interrupt.clone();
        let mut before: Option<Instant> = None;
        ctrlc::set_handler(move || {
            let now = Instant::now();
            if before.is_some_and(|before| now - before < ONE_REQUEST) {
                return;
            }
            before = Some(now);
            let wishes = seen.wish();
            if wishes >= last {
                std::process::exit(130);
            }
            hear(wishes);
        })?;
        Ok(interrupt)
    }

    /// Adds a request to stop, and returns their number.
    pub(crate) fn wish(&self) -> usize {
        self.0.fetch_add(1, Ordering::SeqCst) + 1
    }

    pub(crate) fn wishes(&self) -> usize {
        self.0.load(Ordering::SeqCst)
    }

    pub(crate) fn flow(&self) -> ControlFlow<()> {
        if self.wishes() > 0 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }
}
