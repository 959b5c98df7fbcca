//! Leave-one-out folds, and the chronological split that keeps validation apart from training.

use crate::error::DataError;
use crate::recording::Recording;
use crate::{Window, WindowRule};

/// One leave-one-out fold: some recordings to test on, all others to train on.
#[derive(Debug, Clone)]
pub struct Fold<'a> {
    name: &'static str,
    test: Vec<&'a Recording>,
    training: Vec<&'a Recording>,
    /// Training recordings that are kept for validation whole.
    set_apart: Vec<&'a Recording>,
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
    pub(crate) fn new(
        name: &'static str,
        test_names: &[String],
        recordings: &'a [Recording],
    ) -> Self {
        let test: Vec<_> = test_names
            .iter()
            .filter_map(|name| recordings.iter().find(|r| r.name() == name))
            .collect();
        let held_out = |r: &&Recording| test_names.iter().any(|name| name == r.name());
        let training = recordings.iter().filter(|r| !held_out(r)).collect();
        Self {
            name,
            test,
            training,
            set_apart: Vec::new(),
        }
    }

    /// Keeps training recordings for validation whole: nothing of them is trained on.
    ///
    /// In `star` and `social-gan` no fold tests on `uni_examples` and `zara03`: they show what a model makes of recordings
    /// it has never seen.
    ///
    /// # Errors
    /// [`DataError::NotATrainingRecording`] for a name that is not a training recording of this fold.
    pub fn set_apart(mut self, names: &[String]) -> Result<Self, DataError> {
        for name in names {
            let index = self.training.iter().position(|r| r.name() == name);
            let index = index.ok_or_else(|| DataError::NotATrainingRecording {
                fold: self.name,
                name: name.clone(),
                known: self.training.iter().map(|r| r.name().to_owned()).collect(),
            })?;
            self.set_apart.push(self.training.remove(index));
        }
        Ok(self)
    }

    /// The fold's name, that of its test scene.
    pub fn name(&self) -> &'static str {
        self.name
    }

    /// The recordings to test on.
    pub fn test_recordings(&self) -> &[&'a Recording] {
        &self.test
    }

    /// The recordings to train on: all others, but for those set apart.
    pub fn training_recordings(&self) -> &[&'a Recording] {
        &self.training
    }

    /// Training recordings that are kept for validation whole.
    pub fn recordings_set_apart(&self) -> &[&'a Recording] {
        &self.set_apart
    }

    /// The windows to test on, recording by recording, in order of time.
    ///
    /// Under [`WindowRule::Published`], none starts at the very first frame of the first recording,
    /// which the published test loader skips; published numbers are over the rest.
    #[must_use]
    pub fn test_windows(&self, rule: WindowRule) -> Vec<Window> {
        let mut windows: Vec<_> = self.test.iter().flat_map(|r| r.windows(rule)).collect();
        if let (WindowRule::Published, Some(first)) = (rule, self.test.first()) {
            windows
                .retain(|w| w.recording() != first.name() || w.start_frame() != first.frames()[0]);
        }
        windows
    }

    /// All windows to train on, recording by recording, in order of time.
    ///
    /// The published trainer also loses one random window and its last incomplete batch; that is a
    /// matter of the training loop, and every window is here.
    #[must_use]
    pub fn training_windows(&self, rule: WindowRule) -> Vec<Window> {
        self.training.iter().flat_map(|r| r.windows(rule)).collect()
    }

    /// Divides the windows of each training recording at a moment in time.
    ///
    /// The cut of a recording with n annotated frames comes before the frame with index
    /// floor((1 - f) n), f being `validation_fraction` (clamped to [0, 1], NaN taken as 0). Windows
    /// that span the cut belong to neither side, so that no position is seen in both. With f = 0.2
    /// this is the training/validation split of the Social-GAN convention. Recordings [set apart](Self::set_apart) are
    /// validated on whole.
    #[must_use]
    pub fn training_split(&self, rule: WindowRule, validation_fraction: f64) -> TrainingSplit {
        let fraction = if validation_fraction.is_nan() {
            0.0
        } else {
            validation_fraction.clamp(0.0, 1.0)
        };
        let mut split = TrainingSplit {
            training: Vec::new(),
            validation: Vec::new(),
        };
        for recording in &self.training {
            let frames = recording.frames();
            #[expect(clippy::cast_sign_loss, reason = "a share of a count is not negative")]
            let cut = ((1.0 - fraction) * frames.len() as f64).floor() as usize;
            for window in recording.windows(rule) {
                let (first, last) = (window.start_frame(), window.frames()[window.steps() - 1]);
                match frames.get(cut) {
                    Some(&cut) if first >= cut => split.validation.push(window),
                    Some(&cut) if last >= cut => {}
                    _ => split.training.push(window),
                }
            }
        }
        let set_apart = self.set_apart.iter().flat_map(|r| r.windows(rule));
        split.validation.extend(set_apart);
        split
    }
}
