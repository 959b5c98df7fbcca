//! Ctrl-C as a wish to stop that the work looks at between two steps.

use std::ops::ControlFlow;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::{Duration, Instant};

/// Signals that follow each other so quickly are one wish: who ends all processes of a job at once signals this one and the one that
/// started it, which passes it on.
const TOGETHER: Duration = Duration::from_millis(300);

#[derive(Debug, Clone, Default)]
pub(crate) struct Interrupt(Arc<AtomicUsize>);

impl Interrupt {
    /// Catches Ctrl-C (SIGINT) and SIGTERM from now on; a second one ends the program at once.
    pub(crate) fn catch() -> anyhow::Result<Self> {
        Self::catch_until(2, |_| {})
    }

    /// Catches Ctrl-C (SIGINT) and SIGTERM from now on, and hears the number of each; the `last` ends the program at once.
    pub(crate) fn catch_until(
        last: usize,
        hear: impl Fn(usize) + Send + 'static,
    ) -> anyhow::Result<Self> {
        let interrupt = Self::default();
        let seen = interrupt.clone();
        let mut before: Option<Instant> = None;
        ctrlc::set_handler(move || {
            let now = Instant::now();
            if before.is_some_and(|before| now - before < TOGETHER) {
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

    /// One more wish to stop; how many there are.
    pub(crate) fn wish(&self) -> usize {
        self.0.fetch_add(1, Ordering::SeqCst) + 1
    }

    pub(crate) fn wishes(&self) -> usize {
        self.0.load(Ordering::SeqCst)
    }

    pub(crate) fn flow(&self) -> ControlFlow<()> {
        if self.wishes() > 0 {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        }
    }
}
