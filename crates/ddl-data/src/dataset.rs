//! A data set: all recordings of one convention.

use std::path::Path;

use crate::convention::Convention;
use crate::error::DataError;
use crate::fold::Fold;
use crate::format::read_recording;
use crate::recording::Recording;
use crate::simulate;

/// All recordings of one data convention, in the order of `folds.toml`.
///
/// ```
/// use ddl_data::{Dataset, WindowRule};
///
/// let dataset = Dataset::simulated(1);
/// let fold = dataset.fold("corridor")?;
/// assert_eq!(fold.training_recordings().len(), 4);
/// assert!(fold.test_windows(WindowRule::Published).len() > 100);
/// # Ok::<(), ddl_data::DataError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Dataset {
    convention: Convention,
    recordings: Vec<Recording>,
}

impl Dataset {
    /// Reads all recordings of a convention from the folder that holds its files (see
    /// [`locate`](crate::locate)).
    ///
    /// # Errors
    /// If a file is missing or cannot be read, or its content is wrong (the message names file, line
    /// and field), and for [`Convention::Simulated`], which has no files.
    pub fn load(convention: Convention, folder: &Path) -> Result<Self, DataError> {
        let format = convention.format().ok_or(DataError::NoFiles)?;
        let mut recordings = Vec::new();
        for planned in &convention.plan().recordings {
            let file = planned.file.as_deref().ok_or(DataError::NoFiles)?;
            let recording = read_recording(&folder.join(file), format)?
                .with_name(planned.name.as_str())
                .with_frame_step(planned.frame_step)
                .map_err(|source| DataError::Recording {
                    name: planned.name.clone(),
                    source,
                })?;
            recordings.push(recording);
        }
        Ok(Self {
            convention,
            recordings,
        })
    }

    /// Simulates the five scenes of [`simulate`]; the same seed gives the same bytes.
    #[must_use]
    pub fn simulated(seed: u64) -> Self {
        let recordings = simulate::Scene::ALL
            .into_iter()
            .map(|scene| scene.simulate(seed).into_recording())
            .collect();
        Self {
            convention: Convention::Simulated,
            recordings,
        }
    }

    /// The convention of all its recordings.
    pub fn convention(&self) -> Convention {
        self.convention
    }

    /// The recordings, in the order of `folds.toml`.
    pub fn recordings(&self) -> &[Recording] {
        &self.recordings
    }

    /// The recording of this name.
    ///
    /// # Errors
    /// If there is none; the message lists those there are.
    pub fn recording(&self, name: &str) -> Result<&Recording, DataError> {
        self.recordings
            .iter()
            .find(|r| r.name() == name)
            .ok_or_else(|| DataError::UnknownRecording {
                convention: self.convention,
                name: name.to_owned(),
                known: self
                    .recordings
                    .iter()
                    .map(|r| r.name().to_owned())
                    .collect(),
            })
    }

    /// Names of the leave-one-out folds: eth, hotel, univ, zara1, zara2, or the simulated scenes.
    pub fn fold_names(&self) -> Vec<&'static str> {
        self.convention.fold_names().collect()
    }

    /// The fold of this name: test on its recordings, train on all others.
    ///
    /// # Errors
    /// If there is none; the message lists those there are.
    pub fn fold(&self, name: &str) -> Result<Fold<'_>, DataError> {
        let plan = self
            .convention
            .plan()
            .folds
            .iter()
            .find(|f| f.name == name)
            .ok_or_else(|| DataError::UnknownFold {
                convention: self.convention,
                name: name.to_owned(),
                known: self.fold_names().into_iter().map(str::to_owned).collect(),
            })?;
        Ok(Fold::new(&plan.name, &plan.test, &self.recordings))
    }

    /// Every fold, in order.
    #[must_use]
    pub fn folds(&self) -> Vec<Fold<'_>> {
        let plans = self.convention.plan().folds.iter();
        plans
            .map(|plan| Fold::new(&plan.name, &plan.test, &self.recordings))
            .collect()
    }
}
