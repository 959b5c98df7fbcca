//! Windows with the memory of their places.

use crate::error::DdlError;
use crate::goals::model::GoalModel;
use crate::run::folds::fold_by_name;
use ddl_core::Window;
use ddl_data::{Convention, Dataset, Fold, Recording};
use ddl_memory::{Playback, SceneMemory};
use std::collections::BTreeMap;

/// The recordings that the memory of a window may hold.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Remembering {
    /// The training recordings of the same place.
    Place,
    /// The recording of the window before its last observed frame. The training recordings of the same place are added
    /// if they are [confirmed](ddl_data::Fold::place_memory_confirmed_by).
    Online,
}

ddl_core::named!(Remembering, "memory", Place => "place", Online => "online");

impl GoalModel {
    /// Adds to each window the memory of its place: tracks of earlier pedestrians in the recordings of the dataset.
    ///
    /// # Errors
    /// When the model has no memory branch.
    pub fn remembering(
        &self,
        windows: &[Window],
        dataset: &Dataset,
        what: Remembering,
    ) -> Result<Vec<Window>, DdlError> {
        let count = self.recalled_per_pedestrian()?;
        let fold = self.fold_with_places(dataset)?;
        let of_place = |recording: &str| -> Vec<&Recording> {
            let trained_fold =
                fold.as_ref().filter(|fold| what == Remembering::Place || !fold.place_memory_confirmed_by().is_empty());
            trained_fold.map_or_else(Vec::new, |fold| fold.training_recordings_of_place(recording))
        };
        let playback = match what {
            Remembering::Place => None,
            Remembering::Online => Some(Playback::Forward),
        };
        let recordings: Vec<&Recording> = dataset.recordings().iter().collect();
        remembering(&recordings, windows, of_place, playback, count)
    }

    /// The fold that the model was trained on; `None` for own recordings, and if the dataset has another convention.
    fn fold_with_places<'a>(&self, dataset: &'a Dataset) -> Result<Option<Fold<'a>>, DdlError> {
        let data = &self.config().data;
        if dataset.convention() != data.convention || data.convention == Convention::Own {
            return Ok(None);
        }
        let fold = fold_by_name(dataset, &data.fold)?;
        Ok(Some(fold.with_validation_recordings(&data.validation_recordings)?))
    }

    /// Whether `fair` and `single` forecasts remember training recordings from the place of the test recordings.
    pub(crate) fn remembers_place(&self, dataset: &Dataset) -> Result<bool, DdlError> {
        let fold = self.fold_with_places(dataset)?;
        let confirmed = fold.is_some_and(|fold| !fold.place_memory_confirmed_by().is_empty());
        Ok(confirmed && self.memory().is_some())
    }
}

/// Adds to each pedestrian of the windows at most `count` earlier pedestrians. They come from the recordings that
/// `of_place` gives for the name of the window's recording and, with a playback, from the window's own recording before
/// its last observed frame.
pub(crate) fn remembering<'a>(
    recordings: &[&'a Recording],
    windows: &[Window],
    of_place: impl Fn(&str) -> Vec<&'a Recording>,
    playback: Option<Playback>,
    count: usize,
) -> Result<Vec<Window>, DdlError> {
    let mut of_recording: BTreeMap<&str, Vec<usize>> = BTreeMap::new();
    for (index, window) in windows.iter().enumerate() {
        of_recording.entry(window.recording()).or_default().push(index);
    }
    let mut remembering = windows.to_vec();
    for recording in recordings {
        let Some(indices) = of_recording.remove(recording.name()) else {
            continue;
        };
        let mut memory = SceneMemory::new(recording.frame_step(), SceneMemory::DEFAULT_CAPACITY)?;
        for other in of_place(recording.name()) {
            memory.observe_recording(other)?;
        }
        let some = indices.iter().map(|&index| windows[index].clone());
        let some: Vec<Window> = match playback {
            Some(playback) => memory.replay(recording, playback, some.collect(), count)?,
            None => some.map(|window| memory.recalling(window, count)).collect(),
        };
        for (index, window) in indices.into_iter().zip(some) {
            remembering[index] = window;
        }
    }
    Ok(remembering)
}
