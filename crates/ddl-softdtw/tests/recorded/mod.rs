//! Velocities of the walkers of the real recordings, for tests and benchmarks.

#![allow(dead_code, reason = "each program needs a part")]

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

pub(crate) type Track = Vec<[f64; 2]>;

/// Recordings by the scene that is left out together.
pub(crate) const SCENES: [(&str, &[&str]); 4] = [
    ("eth", &["eth"]),
    ("hotel", &["hotel"]),
    ("zara", &["zara01", "zara02", "zara03"]),
    ("univ", &["students001", "students003", "uni_examples"]),
];

/// Seconds between two frames of a track.
const TIME_STEP: f64 = 0.4;

/// The folder of the recordings, or `None` where they may be absent.
pub(crate) fn folder() -> Option<PathBuf> {
    let folder = PathBuf::from(std::env::var_os("DDL_DATASETS")?);
    [folder.join("star"), folder]
        .into_iter()
        .find(|folder| folder.join("eth.csv").is_file())
}

/// Frame to position (m) of every walker of a recording, by pedestrian: the file has four lines, of frames, pedestrians, y
/// and x.
pub(crate) fn walkers(folder: &Path, recording: &str) -> BTreeMap<i64, BTreeMap<i64, [f64; 2]>> {
    let path = folder.join(format!("{recording}.csv"));
    let text = std::fs::read_to_string(&path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
    let parse = |field: &str| field.trim().parse::<f64>().expect("a number");
    let rows: Vec<Vec<f64>> = text
        .lines()
        .map(|line| line.split(',').map(parse).collect())
        .collect();
    let [frames, pedestrians, ys, xs] = rows.as_slice() else {
        panic!("{}: four lines are expected", path.display())
    };
    let mut walkers: BTreeMap<i64, BTreeMap<i64, [f64; 2]>> = BTreeMap::new();
    for i in 0..frames.len() {
        let walker = walkers.entry(pedestrians[i] as i64).or_default();
        walker.insert(frames[i] as i64, [xs[i], ys[i]]);
    }
    walkers
}

/// Frames of a recording from one position to the next.
pub(crate) fn frame_step(recording: &str) -> i64 {
    if recording == "eth" { 6 } else { 10 }
}

/// Forward differences (m/s).
pub(crate) fn differences(positions: &[[f64; 2]]) -> Track {
    let velocity = |pair: &[[f64; 2]]| [0, 1].map(|d| (pair[1][d] - pair[0][d]) / TIME_STEP);
    positions.windows(2).map(velocity).collect()
}

/// Velocities (m/s) of every walker of a recording over every stretch without a gap, in order of pedestrian and time.
pub(crate) fn velocities(folder: &Path, recording: &str) -> Vec<Track> {
    let mut tracks = Vec::new();
    for walker in walkers(folder, recording).into_values() {
        let positions: Vec<_> = walker.into_iter().collect();
        for stretch in positions.chunk_by(|a, b| b.0 - a.0 == frame_step(recording)) {
            let positions: Track = stretch.iter().map(|&(_, position)| position).collect();
            tracks.push(differences(&positions));
        }
    }
    tracks
}

/// Tracks of one scene, and those of all the others.
pub(crate) fn split(folder: &Path, scene: &str) -> (Vec<Track>, Vec<Track>) {
    let (mut inside, mut outside) = (Vec::new(), Vec::new());
    for (name, recordings) in SCENES {
        let into = if name == scene {
            &mut inside
        } else {
            &mut outside
        };
        for recording in recordings {
            into.extend(velocities(folder, recording));
        }
    }
    (inside, outside)
}
