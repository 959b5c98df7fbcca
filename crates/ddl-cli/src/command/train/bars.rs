//! Progress of a training: a bar for each stage, and the position when it was interrupted.

use crate::progress::{Progress, ProgressMode};
use ddl::{TrainingProgress, TrainingStep, WorkDone};

pub(super) struct TrainingBars {
    mode: ProgressMode,
    goals: Option<Progress>,
    network: Option<Progress>,
    stood: String,
}

impl TrainingBars {
    pub(super) fn new(mode: ProgressMode) -> Self {
        Self { mode, goals: None, network: None, stood: "before its first step".to_owned() }
    }

    pub(super) fn tell(&mut self, now: &TrainingProgress) {
        let WorkDone { done, total } = now.steps;
        let mode = self.mode;
        match &now.step {
            TrainingStep::Goals(step) => {
                self.stood = format!("after {done} of {total} batches of goals");
                let message = format!("batches, endpoint error {:.2} m", step.distance);
                self.goals.get_or_insert_with(|| Progress::new("goals", mode)).tell(done, total, &message);
            }
            TrainingStep::Network(step) => {
                self.goals = None;
                self.stood = format!("in epoch {}, after {done} of {total} batches", step.epoch);
                let message = format!("batches, epoch {} loss {:.4}", step.epoch, step.loss);
                self.network.get_or_insert_with(|| Progress::new("train", mode)).tell(done, total, &message);
            }
        }
    }

    /// Removes the bars, and returns the position of the training.
    pub(super) fn close(self) -> String {
        self.stood
    }
}
