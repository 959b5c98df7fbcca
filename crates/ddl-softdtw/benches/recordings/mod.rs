//! Windows to measure with: of the real recordings where they are, of synthetic walkers otherwise.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

pub(crate) type Walk = Vec<[f64; 2]>;

/// Frames of a window: 8 observed and 12 to come.
const FRAMES: i64 = 20;
/// Seconds from one frame to the next.
const TIME_STEP: f64 = 0.4;
/// Recordings that candidates are taken from, with the frames from one position to the next.
const CANDIDATES: [(&str, i64); 7] = [
    ("hotel", 10),
    ("zara01", 10),
    ("zara02", 10),
    ("zara03", 10),
    ("students001", 10),
    ("students003", 10),
    ("uni_examples", 10),
];
/// The recording that queries are taken from.
const QUERIES: (&str, i64) = ("eth", 6);

/// Candidates, queries and where they come from.
pub(crate) struct Windows {
    pub(crate) source: &'static str,
    pub(crate) candidates: Vec<Walk>,
    pub(crate) queries: Vec<Walk>,
}

impl Windows {
    /// The first `steps` velocities (m/s) of all complete windows: those of one recording against those of seven others.
    pub(crate) fn load(steps: usize) -> Self {
        let Some(folder) = folder() else {
            return Self {
                source: "synthetic",
                candidates: walkers(37_000, steps, 2),
                queries: walkers(400, steps, 3),
            };
        };
        let candidates = CANDIDATES
            .iter()
            .flat_map(|&(name, step)| windows(&folder, name, step, steps));
        Self {
            source: "real",
            candidates: candidates.collect(),
            queries: windows(&folder, QUERIES.0, QUERIES.1, steps),
        }
    }

    /// `count` queries, evenly spread.
    pub(crate) fn some_queries(&self, count: usize) -> Vec<Walk> {
        let every = self.queries.len().div_ceil(count).max(1);
        self.queries.iter().step_by(every).cloned().collect()
    }
}

/// The folder that `DDL_DATASETS` names, if the recordings lie in it.
fn folder() -> Option<PathBuf> {
    let folder = PathBuf::from(std::env::var_os("DDL_DATASETS")?);
    [folder.join("star"), folder]
        .into_iter()
        .find(|folder| folder.join("eth.csv").is_file())
}

/// Velocities of the complete windows of a recording: four lines of frame, pedestrian, y (m) and x (m).
fn windows(folder: &Path, name: &str, step: i64, steps: usize) -> Vec<Walk> {
    let path = folder.join(format!("{name}.csv"));
    let text = std::fs::read_to_string(&path).expect("a readable recording");
    let lines: Vec<Vec<f64>> = text
        .lines()
        .map(|line| {
            let fields = line.split(',').map(|field| field.trim().parse());
            fields.collect::<Result<_, _>>().expect("numbers")
        })
        .collect();
    let [frames, pedestrians, ys, xs] = lines.as_slice() else {
        panic!("{}: four lines were expected", path.display());
    };
    let mut tracks: BTreeMap<i64, BTreeMap<i64, [f64; 2]>> = BTreeMap::new();
    for ((frame, pedestrian), (y, x)) in frames.iter().zip(pedestrians).zip(ys.iter().zip(xs)) {
        let track = tracks.entry(*pedestrian as i64).or_default();
        track.insert(*frame as i64, [*x, *y]);
    }
    let mut windows = Vec::new();
    for track in tracks.values() {
        for &start in track.keys() {
            let positions = (0..FRAMES).map(|i| track.get(&(start + i * step)).copied());
            let Some(positions) = positions.collect::<Option<Walk>>() else {
                continue;
            };
            let velocity = |pair: &[[f64; 2]]| {
                let [from, to] = [pair[0], pair[1]];
                [(to[0] - from[0]) / TIME_STEP, (to[1] - from[1]) / TIME_STEP]
            };
            windows.push(positions.windows(2).take(steps).map(velocity).collect());
        }
    }
    windows
}

/// Velocities (m/s) of walkers with constant headings and some sway, one in ten of them standing.
pub(crate) fn walkers(count: usize, steps: usize, seed: u64) -> Vec<Walk> {
    let mut state = seed;
    let mut next = || {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 53) as f64
    };
    (0..count)
        .map(|_| {
            let speed = if next() < 0.1 {
                0.0
            } else {
                0.4 + 1.2 * next()
            };
            let (sin, cos) = (std::f64::consts::TAU * next()).sin_cos();
            let mut sway = || 0.1 * (speed + 0.1) * (next() - 0.5);
            (0..steps)
                .map(|_| [speed * cos + sway(), speed * sin + sway()])
                .collect()
        })
        .collect()
}
