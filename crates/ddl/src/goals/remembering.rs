//! Windows with the memory of their places.

use crate::error::DdlError;
use ddl_core::Window;
use ddl_data::Recording;
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
        let indices = of_recording.entry(window.recording()).or_default();
        indices.push(index);
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
