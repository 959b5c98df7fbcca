//! Windows to measure with: of the real recordings where they are, of synthetic walkers otherwise.

#[path = "../../tests/recorded/mod.rs"]
mod recorded;

use std::path::Path;

pub(crate) type Walk = Vec<[f64; 2]>;

/// Frames of a window: 8 observed and 12 to come.
const FRAMES: i64 = 20;
/// Recordings that candidates are taken from.
const CANDIDATES: [&str; 7] = [
    "hotel",
    "zara01",
    "zara02",
    "zara03",
    "students001",
    "students003",
    "uni_examples",
];
/// The recording that queries are taken from.
const QUERIES: &str = "eth";

/// Candidates, queries and where they come from.
pub(crate) struct Windows {
    pub(crate) source: &'static str,
    pub(crate) candidates: Vec<Walk>,
    pub(crate) queries: Vec<Walk>,
}

impl Windows {
    /// The first `steps` velocities (m/s) of all complete windows: those of one recording against those of seven others.
    pub(crate) fn load(steps: usize) -> Self {
        let Some(folder) = recorded::folder() else {
            return Self {
                source: "synthetic",
                candidates: walkers(37_000, steps, 2),
                queries: walkers(400, steps, 3),
            };
        };
        let candidates = CANDIDATES
            .iter()
            .flat_map(|name| windows(&folder, name, steps));
        Self {
            source: "real",
            candidates: candidates.collect(),
            queries: windows(&folder, QUERIES, steps),
        }
    }

    /// `count` queries, evenly spread.
    pub(crate) fn some_queries(&self, count: usize) -> Vec<Walk> {
        let every = self.queries.len().div_ceil(count).max(1);
        self.queries.iter().step_by(every).cloned().collect()
    }
}

/// Velocities (m/s) of the complete windows of a recording.
fn windows(folder: &Path, name: &str, steps: usize) -> Vec<Walk> {
    let mut windows = Vec::new();
    for track in recorded::walkers(folder, name).values() {
        for &start in track.keys() {
            let frames = (0..FRAMES).map(|i| start + i * recorded::frame_step(name));
            let positions = frames.map(|frame| track.get(&frame).copied());
            if let Some(positions) = positions.collect::<Option<Walk>>() {
                windows.push(recorded::differences(&positions[..=steps]));
            }
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
