//! The crowd that is forecast.

use crate::Result;
use ddl::data::{Dataset, Window};

const PEDESTRIANS: usize = 25;

/// The first window of the simulated recordings with at least `PEDESTRIANS` pedestrians, reduced to this number.
pub(crate) fn of(dataset: &Dataset) -> Result<Window> {
    let recordings = dataset.recordings().iter();
    let window = recordings
        .flat_map(ddl::data::Recording::observed_windows)
        .find(|window| window.len() >= PEDESTRIANS)
        .ok_or("no simulated scene is crowded enough")?;
    let tracks = (0..PEDESTRIANS).map(|i| window.observed(i).to_vec());
    Ok(Window::new(
        window.recording(),
        window.start_frame(),
        window.frame_step(),
        window.pedestrians()[..PEDESTRIANS].to_vec(),
        tracks.collect(),
    )?)
}
