//! Who works off a plan.

use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use anyhow::Result;

use super::plan::{Plan, Task};

/// Works off a plan whose tasks are independent of each other.
///
/// [`super::Local`] runs processes on this machine. An executor for a cluster takes the same plan:
/// it submits [`Plan::train_arguments`] and [`Plan::evaluate_arguments`] of each task and waits.
pub(crate) trait Executor {
    /// Runs every task that is not finished, and returns how each ended, in the plan's order.
    ///
    /// A task that fails does not keep the others from running. After [`Stop::request`] no task is
    /// begun, and running ones are asked to save what they have.
    ///
    /// # Errors
    /// Only if nothing can be run at all.
    fn run(&self, plan: &Plan, out: &Path, watch: &dyn Watch, stop: &Stop) -> Result<Vec<End>>;
}

/// How a task ended.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum End {
    /// Trained and scored now.
    Finished { seconds: f64 },
    /// An earlier run finished it.
    Kept,
    /// What went wrong, with the last lines of the log.
    Failed { reason: String },
    /// Stopped from outside, or not begun; a later run goes on from here.
    Interrupted,
}

/// Hears how tasks get on, from several threads at once.
pub(crate) trait Watch: Sync {
    fn started(&self, task: &Task);
    /// `fraction` of the task is done, from 0 to 1.
    fn advanced(&self, task: &Task, fraction: f64, message: &str);
    fn ended(&self, task: &Task, end: &End);
}

/// A wish to stop, which may be voiced from a signal handler's thread.
#[derive(Debug, Clone, Default)]
pub(crate) struct Stop(Arc<AtomicUsize>);

impl Stop {
    /// The first wish lets tasks save; another ends them at once.
    pub(crate) fn request(&self) {
        self.0.fetch_add(1, Ordering::SeqCst);
    }

    pub(crate) fn wishes(&self) -> usize {
        self.0.load(Ordering::SeqCst)
    }

    pub(crate) fn is_requested(&self) -> bool {
        self.wishes() > 0
    }
}
