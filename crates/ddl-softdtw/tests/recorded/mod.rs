//! Velocities of the pedestrians of the real recordings, for tests and benchmarks.

#![allow(dead_code, reason = "each program needs a part")]

use ddl_data::{Convention, Dataset, Recording, TIME_STEP, locate};

pub(crate) type Track = Vec<[f64; 2]>;

pub(crate) fn dataset() -> Option<Dataset> {
    let folder = locate(Convention::Star, None).ok()?;
    Some(Dataset::load(Convention::Star, &folder).expect("recordings as published"))
}

pub(crate) fn differences(positions: &[[f64; 2]]) -> Track {
    let velocity = |pair: &[[f64; 2]]| [0, 1].map(|d| (pair[1][d] - pair[0][d]) / TIME_STEP);
    positions.windows(2).map(velocity).collect()
}

/// Velocities (m/s) of every pedestrian of a recording over every interval without a gap, in order of pedestrian and
/// time.
fn velocities(recording: &Recording) -> Vec<Track> {
    let mut tracks = Vec::new();
    for pedestrian in recording.pedestrians() {
        let seen = recording.track(pedestrian);
        for stretch in seen.chunk_by(|a, b| b.frame - a.frame == recording.frame_step()) {
            let positions: Track = stretch.iter().map(|seen| seen.position).collect();
            tracks.push(differences(&positions));
        }
    }
    tracks
}

pub(crate) fn split(dataset: &Dataset, scene: &[&str]) -> [Vec<Track>; 2] {
    let (inside, outside): (Vec<&Recording>, Vec<_>) = dataset
        .recordings()
        .iter()
        .partition(|recording| scene.contains(&recording.name()));
    [inside, outside].map(|recordings| recordings.into_iter().flat_map(velocities).collect())
}
