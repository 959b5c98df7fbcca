//! Progress of a plan: one bar in a terminal, and a line for each task that begins or ends.

use crate::command::benchmark::plan::Task;
use crate::command::benchmark::work::{Event, TaskEnd};
use crate::progress::{Progress, ProgressMode};
use crate::telling::human;
use std::collections::BTreeMap;
use std::sync::{Mutex, PoisonError};
use std::time::Duration;

/// Steps of the bar.
const STEPS: u64 = 1000;

/// Shows progress on standard error, or as JSON on standard output.
#[derive(Debug)]
pub(super) struct Display {
    mode: ProgressMode,
    state: Mutex<DisplayState>,
}

#[derive(Debug)]
struct DisplayState {
    progress: Progress,
    /// The part of each task that is done, from 0 to 1.
    tasks: BTreeMap<String, f64>,
    ended: usize,
}

impl Display {
    pub(super) fn new(tasks: &[Task], mode: ProgressMode) -> Self {
        let state = DisplayState {
            progress: Progress::new("benchmark", mode),
            tasks: tasks.iter().map(|task| (task.id.clone(), 0.0)).collect(),
            ended: 0,
        };
        Self { mode, state: Mutex::new(state) }
    }

    pub(super) fn note_event(&self, task: &Task, event: Event<'_>) {
        let mut state = self.state.lock().unwrap_or_else(PoisonError::into_inner);
        match event {
            Event::Started => self.say(&state, &format!("{}: started", task.id)),
            Event::Advanced(fraction, message) => state.advance(&task.id, fraction, message),
            Event::Ended(end) => {
                state.ended += 1;
                let line = line_of(&task.id, end, state.ended, state.tasks.len());
                match end {
                    TaskEnd::Failed { .. } => state.progress.say(&line),
                    _ => self.say(&state, &line),
                }
                state.advance(&task.id, 1.0, "ended");
            }
        }
    }

    fn say(&self, state: &DisplayState, line: &str) {
        if self.mode == ProgressMode::Auto {
            state.progress.say(line);
        }
    }
}

impl DisplayState {
    fn advance(&mut self, id: &str, fraction: f64, message: &str) {
        if let Some(done) = self.tasks.get_mut(id) {
            *done = fraction.clamp(0.0, 1.0);
        }
        let done = self.tasks.values().sum::<f64>() / self.tasks.len().max(1) as f64;
        let message = format!("steps; {} of {} tasks; {id}: {message}", self.ended, self.tasks.len());
        self.progress.tell((done * STEPS as f64) as u64, STEPS, &message);
    }
}

fn line_of(id: &str, end: &TaskEnd, ended: usize, tasks: usize) -> String {
    match end {
        TaskEnd::Finished { seconds } => {
            let took = human(Duration::from_secs_f64(*seconds));
            format!("{id}: done in {took} ({ended} of {tasks})")
        }
        TaskEnd::Kept => format!("{id}: kept from an earlier run ({ended} of {tasks})"),
        TaskEnd::Failed { reason } => format!("{id}: failed: {reason}"),
        TaskEnd::Interrupted => format!("{id}: stopped"),
    }
}
