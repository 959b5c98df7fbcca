//! Velocities of the walkers of the real recordings, for tests and benchmarks.

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

/// Velocities (m/s) of every walker of a recording over every stretch without a gap, in order of pedestrian and time.
pub(crate) fn velocities(folder: &Path, recording: &str) -> Vec<Track> {
    let path = folder.join(format!("{recording}.csv"));
    let text = std::fs::read_to_string(&path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
    let parse = |field: &str| field.trim().parse::<f64>().expect("a number");
    let rows: Vec<Vec<f64>> = text
        .lines()
        .map(|line| line.split(',').map(parse).collect())
        .collect();
    let [frames, pedestrians, ys, xs] = rows.as_slice() else {
        panic!("{}: four rows are expected", path.display())
    };
    let mut walkers: BTreeMap<i64, BTreeMap<i64, [f64; 2]>> = BTreeMap::new();
    for i in 0..frames.len() {
        let walker = walkers.entry(pedestrians[i] as i64).or_default();
        walker.insert(frames[i] as i64, [xs[i], ys[i]]);
    }
    let frame_step = if recording == "eth" { 6 } else { 10 };
    let mut tracks = Vec::new();
    for walker in walkers.into_values() {
        let positions: Vec<_> = walker.into_iter().collect();
        for stretch in positions.chunk_by(|a, b| b.0 - a.0 == frame_step) {
            let velocity = |pair: &[(i64, [f64; 2])]| {
                let ((_, a), (_, b)) = (pair[0], pair[1]);
                [(b[0] - a[0]) / TIME_STEP, (b[1] - a[1]) / TIME_STEP]
            };
            tracks.push(stretch.windows(2).map(velocity).collect());
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
