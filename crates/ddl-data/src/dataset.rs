//! A data set: all recordings of one convention.

use std::path::Path;

use crate::convention::Convention;
use crate::file_error::DataError;
use crate::fold::Fold;
use crate::format::read_recording;
use crate::recording::Recording;
use crate::simulate;

/// All recordings of one data convention, in the order of `folds.json`.
#[derive(Debug, Clone, PartialEq)]
pub struct Dataset {
    convention: Convention,
    recordings: Vec<Recording>,
}

impl Dataset {
    /// Reads all recordings of a convention from the folder that holds its files (see [`locate`](crate::locate)).
    ///
    /// # Errors
    /// If a file is missing or its content is wrong (the message names file, line and field). Also for
    /// [`Convention::Simulated`] and [`Convention::Own`], which have no files of fixed names.
    pub fn load(convention: Convention, folder: &Path) -> Result<Self, DataError> {
        let format = convention.format().ok_or(DataError::NoFiles(convention.name()))?;
        let mut recordings = Vec::new();
        for planned in &convention.plan().recordings {
            let file = planned.file.as_deref().ok_or(DataError::NoFiles(convention.name()))?;
            let recording = read_recording(&folder.join(file), format)?
                .with_name(planned.name.as_str())
                .with_frame_step(planned.frame_step)
                .map_err(|source| DataError::Recording { name: planned.name.clone(), source })?;
            recordings.push(recording);
        }
        Ok(Self { convention, recordings })
    }

    /// The seed of the crowds of the convention `simulated`, the same for all users.
    pub const CROWD_SEED: u64 = 1;

    /// Simulates crowds in five scenes, for machines without real recordings: a social-force model whose pedestrians
    /// walk, meet, queue, stand and keep together. The same seed gives the same bytes. Accuracy measured on them does
    /// not transfer to real pedestrians.
    #[must_use]
    pub fn simulated(seed: u64) -> Self {
        Self { convention: Convention::Simulated, recordings: simulate::recordings(seed) }
    }

    /// The user's own recordings, in steps of 0.4 s ([`Recording::on_clock`]). Each recording can be left out
    /// as a fold, which has the recording's name.
    ///
    /// # Errors
    /// If there are no recordings, if two have the same name, or if one is called `none` ([`Fold::NO_HELD_OUT`]).
    ///
    /// # Examples
    /// ```
    /// use ddl_core::PedestrianId;
    /// use ddl_data::{Dataset, Observation, Recording, WindowRule};
    ///
    /// let walk = |name: &str| {
    ///     let seen = (0..25).map(|t| Observation::new(t, PedestrianId(1), [0.5 * t as f64, 0.0]));
    ///     Recording::new(name, 1, seen.collect())
    /// };
    /// let own = Dataset::own(vec![walk("lobby")?, walk("yard")?])?;
    /// assert_eq!(own.whole().training_recordings().len(), 2);
    /// assert_eq!(own.fold("lobby")?.test_windows(WindowRule::Complete).len(), 6);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn own(recordings: Vec<Recording>) -> Result<Self, DataError> {
        let problem = |problem: String| Err(DataError::Own { problem });
        if recordings.is_empty() {
            return problem("no recordings; give at least one file of tracks".to_owned());
        }
        for (index, recording) in recordings.iter().enumerate() {
            let name = recording.name();
            if recordings[..index].iter().any(|other| other.name() == name) {
                return problem(format!("two recordings are called {name:?}; give one of the files another name"));
            }
            if name == Fold::NO_HELD_OUT {
                return problem(format!(
                    "a recording is called {name:?}, which is the name of the fold without a test recording; \
                     rename the file"
                ));
            }
        }
        Ok(Self { convention: Convention::Own, recordings })
    }

    /// The convention of all its recordings.
    pub fn convention(&self) -> Convention {
        self.convention
    }

    /// The recordings, in the order of `folds.json`.
    pub fn recordings(&self) -> &[Recording] {
        &self.recordings
    }

    /// The recording of this name.
    ///
    /// # Errors
    /// If there is no such recording; the message lists the available ones.
    pub fn recording(&self, name: &str) -> Result<&Recording, DataError> {
        self.recordings.iter().find(|r| r.name() == name).ok_or_else(|| DataError::Unknown {
            kind: "recording",
            convention: self.convention.name(),
            name: name.to_owned(),
            known: self.recordings.iter().map(|r| r.name().to_owned()).collect(),
        })
    }

    /// Names of the leave-one-out folds: eth, hotel, univ, zara1, zara2, or the simulated scenes, or the own
    /// recordings.
    pub fn fold_names(&self) -> Vec<&str> {
        match self.convention {
            Convention::Own => self.recordings.iter().map(Recording::name).collect(),
            planned => planned.fold_names().collect(),
        }
    }

    /// The fold that leaves no recording out: it trains on all and tests on none. Its name is [`Fold::NO_HELD_OUT`].
    #[must_use]
    pub fn whole(&self) -> Fold<'_> {
        Fold::new(Fold::NO_HELD_OUT, &[], &self.recordings, None)
    }

    /// The fold of this name: it tests on its recordings and trains on all others.
    ///
    /// # Errors
    /// If there is no such fold; the message lists the available ones.
    pub fn fold(&self, name: &str) -> Result<Fold<'_>, DataError> {
        let unknown = || DataError::Unknown {
            kind: "fold",
            convention: self.convention.name(),
            name: name.to_owned(),
            known: self.fold_names().into_iter().map(str::to_owned).collect(),
        };
        if self.convention == Convention::Own {
            let name = self.recordings.iter().find(|r| r.name() == name).ok_or_else(unknown)?.name();
            return Ok(Fold::new(name, &[name.to_owned()], &self.recordings, None));
        }
        let convention = self.convention.plan();
        let mut folds = convention.folds.iter();
        let plan = folds.find(|f| f.name == name).ok_or_else(unknown)?;
        Ok(Fold::new(&plan.name, &plan.test, &self.recordings, Some((convention, plan))))
    }

    /// Every fold, in order.
    #[must_use]
    pub fn folds(&self) -> Vec<Fold<'_>> {
        self.fold_names().into_iter().filter_map(|name| self.fold(name).ok()).collect()
    }
}
