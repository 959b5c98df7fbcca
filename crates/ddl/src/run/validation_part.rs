//! The part of own recordings that training keeps for validation.

use ddl_core::Window;
use ddl_data::{Convention, Fold, Recording};

/// Share of the time of own recordings, at their ends, that is kept for validation.
const SHARE: f64 = 0.2;
/// The ends are too short for validation if they hold a smaller share of all pedestrian-windows than this.
const LEAST_AT_THE_ENDS: f64 = 0.05;
/// Epochs without a smaller validation error.
const PATIENCE: usize = 10;
/// One in this many recordings is kept whole.
const WHOLE_EVERY: usize = 5;

/// The part of recordings that is kept out of training for validation.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ValidationPart {
    /// Share of the recordings' time, at their ends; 0 for none.
    pub share: f64,
    /// Recordings that are kept whole.
    pub recordings: Vec<String>,
}

impl ValidationPart {
    /// Whether nothing is kept.
    pub fn is_empty(&self) -> bool {
        self.share <= 0.0 && self.recordings.is_empty()
    }

    /// After so many epochs without a smaller validation error training ends, if nothing else is asked for; 0: never.
    /// Training on conventions of the literature takes all epochs.
    pub fn patience(&self, convention: Convention) -> usize {
        if convention == Convention::Own && !self.is_empty() { PATIENCE } else { 0 }
    }

    /// The default validation part of own recordings: the last fifth of each. If these ends hold too few windows, it is
    /// a fifth of the recordings as a whole, at least one, spread evenly over those with windows.
    #[must_use]
    pub fn of_own(fold: &Fold<'_>) -> Self {
        let ends = Self { share: SHARE, recordings: Vec::new() };
        let rule = Convention::Own.headline_rule();
        let pedestrians = |windows: &[Window]| windows.iter().map(Window::len).sum::<usize>() as f64;
        let at_the_ends = pedestrians(&fold.training_split(rule, SHARE).validation);
        let in_all = pedestrians(&fold.training_windows(rule));
        if at_the_ends > LEAST_AT_THE_ENDS * in_all {
            return ends;
        }
        let with_windows = |recording: &&&Recording| !recording.windows(rule).is_empty();
        let recordings: Vec<&&Recording> = fold.training_recordings().iter().filter(with_windows).collect();
        // A single recording cannot be kept whole: none would be left for training.
        if recordings.len() < 2 {
            return ends;
        }
        let count = recordings.len().div_ceil(WHOLE_EVERY);
        let in_the_middle_of = |part: usize| (2 * part + 1) * recordings.len() / (2 * count);
        Self {
            share: 0.0,
            recordings: (0..count).map(|part| recordings[in_the_middle_of(part)].name().to_owned()).collect(),
        }
    }
}
