//! Leave-one-out folds, and the chronological split that keeps validation apart from training.

use ddl_core::Window;

use crate::convention_plan::{ConventionPlan, FoldPlan};
use crate::file_error::DataError;
use crate::recording::Recording;
use crate::rule::WindowRule;

/// One leave-one-out fold: some recordings to test on, all others to train on.
#[derive(Debug, Clone)]
pub struct Fold<'a> {
    name: &'a str,
    test: Vec<&'a Recording>,
    training: Vec<&'a Recording>,
    set_apart: Vec<&'a Recording>,
    planned: Option<(&'static ConventionPlan, &'static FoldPlan)>,
}

/// The windows of a fold's training recordings, divided by time.
#[derive(Debug, Clone, PartialEq)]
pub struct TrainingSplit {
    /// Windows that end before the cut of their recording.
    pub training: Vec<Window>,
    /// Windows that start at or after the cut of their recording.
    pub validation: Vec<Window>,
}

impl<'a> Fold<'a> {
    /// Name of the fold that leaves no recording out ([`Dataset::whole`](crate::Dataset::whole)).
    pub const NO_HELD_OUT: &'static str = "none";

    pub(crate) fn new(
        name: &'a str,
        test_names: &[String],
        recordings: &'a [Recording],
        planned: Option<(&'static ConventionPlan, &'static FoldPlan)>,
    ) -> Self {
        let test: Vec<_> = test_names.iter().filter_map(|name| recordings.iter().find(|r| r.name() == name)).collect();
        let held_out = |r: &&Recording| test_names.iter().any(|name| name == r.name());
        let training = recordings.iter().filter(|r| !held_out(r)).collect();
        Self { name, test, training, set_apart: Vec::new(), planned }
    }

    /// Keeps whole training recordings for validation; they are not used for training.
    ///
    /// # Errors
    /// [`DataError::NotATrainingRecording`] for a name that is not a training recording of this fold.
    pub fn with_validation_recordings(mut self, names: &[String]) -> Result<Self, DataError> {
        for name in names {
            let index = self.training.iter().position(|r| r.name() == name);
            let index = index.ok_or_else(|| DataError::NotATrainingRecording {
                name: name.clone(),
                known: self.training.iter().map(|r| r.name().to_owned()).collect(),
            })?;
            self.set_apart.push(self.training.remove(index));
        }
        Ok(self)
    }

    /// The fold's name, that of its test scene.
    pub fn name(&self) -> &'a str {
        self.name
    }

    /// The recordings to test on.
    pub fn test_recordings(&self) -> &[&'a Recording] {
        &self.test
    }

    /// The recordings to train on: all others, except those set apart.
    pub fn training_recordings(&self) -> &[&'a Recording] {
        &self.training
    }

    /// Training recordings kept whole for validation.
    pub fn validation_recordings(&self) -> &[&'a Recording] {
        &self.set_apart
    }

    /// The other training recordings made at the place of this recording; empty where places are not known.
    #[must_use]
    pub fn training_recordings_of_place(&self, recording: &str) -> Vec<&'a Recording> {
        let place_of = |name: &str| {
            let (convention, _) = self.planned?;
            let mut recordings = convention.recordings.iter();
            recordings.find(|r| r.name == name)?.place.as_deref()
        };
        let place = place_of(recording);
        // The recording itself is left out: if its end is kept for validation, it would reveal its own future.
        let same = |r: &&&Recording| r.name() != recording && place.is_some() && place_of(r.name()) == place;
        self.training.iter().filter(same).copied().collect()
    }

    /// Two training recordings made at the place of the test recordings, which confirm that a memory of the place
    /// helps. For a model trained without the second recording, a memory of the first improved the goals in the second.
    /// Empty if this is not confirmed; then the forecasts of the fold use no memory of the place.
    pub fn place_memory_confirmed_by(&self) -> &[String] {
        self.planned.map_or(&[], |(_, fold)| &fold.place_memory)
    }

    /// The windows to test on, recording by recording, in order of time.
    ///
    /// As in the published loader, [`WindowRule::Published`] leaves out the window that starts at the first frame of
    /// the first recording.
    #[must_use]
    pub fn test_windows(&self, rule: WindowRule) -> Vec<Window> {
        let mut windows: Vec<_> = self.test.iter().flat_map(|r| r.windows(rule)).collect();
        if let (WindowRule::Published, Some(first)) = (rule, self.test.first()) {
            windows.retain(|w| w.recording() != first.name() || w.start_frame() != first.frames()[0]);
        }
        windows
    }

    /// All windows to train on, recording by recording, in order of time.
    #[must_use]
    pub fn training_windows(&self, rule: WindowRule) -> Vec<Window> {
        self.training.iter().flat_map(|r| r.windows(rule)).collect()
    }

    /// Splits the windows of each training recording at a point in time.
    ///
    /// The cut of a recording with n annotated frames lies before the frame with index floor((1 - f) n), where f is
    /// `validation_fraction` (clamped to [0, 1], NaN taken as 0). Windows that span the cut belong to neither side.
    /// Recordings [set apart](Self::with_validation_recordings) are used for validation as a whole.
    #[must_use]
    pub fn training_split(&self, rule: WindowRule, validation_fraction: f64) -> TrainingSplit {
        let mut split = TrainingSplit { training: Vec::new(), validation: Vec::new() };
        for recording in &self.training {
            let frames = recording.frames();
            let cut = cut_index(recording, validation_fraction);
            for window in recording.windows(rule) {
                let (first, last) = (window.start_frame(), window.frames()[window.steps() - 1]);
                match frames.get(cut) {
                    Some(&cut) if first >= cut => split.validation.push(window),
                    Some(&cut) if last >= cut => {}
                    _ => split.training.push(window),
                }
            }
        }
        split.validation.extend(self.set_apart.iter().flat_map(|r| r.windows(rule)));
        split
    }
}

/// Index of the annotated frame at which the last share of a recording begins.
fn cut_index(recording: &Recording, share: f64) -> usize {
    // NaN counts as 0.
    let first = (1.0 - share.max(0.0).clamp(0.0, 1.0)) * recording.frames().len() as f64;
    (first.floor() as usize).min(recording.frames().len())
}
