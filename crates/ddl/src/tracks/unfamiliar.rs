//! Motions unlike the training motions, in words.

use crate::tracks::moment::Moment;
use crate::trust::familiarity::UNFAMILIAR_THRESHOLD;

/// The motions of forecasts so far, and those unlike the training motions.
#[derive(Debug, Default)]
pub struct UnfamiliarMotions {
    motions: usize,
    unfamiliar: usize,
    /// Whose motion was the first, and when.
    first: Option<String>,
    is_told: bool,
}

impl UnfamiliarMotions {
    /// Counts the motions of these moments.
    pub fn add(&mut self, moments: &[Moment<'_>]) {
        for moment in moments {
            for i in 0..moment.window.len() {
                self.motions += 1;
                let familiarity = moment.forecast.familiarity(i);
                if familiarity.is_some_and(|f| f < UNFAMILIAR_THRESHOLD) {
                    self.unfamiliar += 1;
                    let first = || format!("{} observed until {}", moment.who(i), moment.when());
                    self.first.get_or_insert_with(first);
                }
            }
        }
    }

    /// A warning, if there are such motions; only once.
    pub fn warning(&mut self) -> Option<String> {
        let first = self.first.as_ref().filter(|_| !self.is_told)?;
        self.is_told = true;
        Some(format!(
            "warning: {} of {} motions are unlike the training motions (familiarity below {}), first that of \
             pedestrian {first}: their forecasts use little of the network, and their weights are flatter",
            self.unfamiliar, self.motions, UNFAMILIAR_THRESHOLD
        ))
    }
}
