//! Progress of a training: a bar for each stage, and the position when it was interrupted.

use crate::progress::{Progress, ProgressMode};
use ddl::{TrainingProgress, TrainingStep, WorkDone};

pub(super) struct TrainingBars {
    mode: ProgressMode,
    goals: Option<Progress>,
    network: Option<Progress>,
    stood: String,
    /// The last loss that was read back; on CUDA this does not happen at every step.
    loss: String,
}

impl TrainingBars {
    pub(super) fn new(mode: ProgressMode) -> Self {
        Self {
            mode,
            goals: None,
            network: None,
            stood: "before its first step".to_owned(),
            loss: String::new(),
        }
    }

    pub(super) fn tell(&mut self, now: &TrainingProgress) {
        let WorkDone { done, total } = now.steps;
        let mode = self.mode;
        match &now.step {
            TrainingStep::Goals(step) => {
                self.stood = format!("after {done} of {total} batches of goals");
                let message = format!("batches, endpoint error {:.2} m", step.distance);
                let bar = self.goals.get_or_insert_with(|| Progress::new("goals", mode));
                bar.tell(done, total, &message);
            }
            TrainingStep::Network(step) => {
                if let Some(loss) = step.loss {
                    self.loss = format!(" loss {loss:.4}");
                }
                self.goals = None;
                self.stood = format!("in epoch {}, after {done} of {total} batches", step.epoch);
                let message = format!("batches, epoch {}{}", step.epoch, self.loss);
                let bar = self.network.get_or_insert_with(|| Progress::new("train", mode));
                bar.tell(done, total, &message);
            }
        }
    }

    /// Removes the bars, and returns the position of the training.
    pub(super) fn close(self) -> String {
        self.stood
    }
}
