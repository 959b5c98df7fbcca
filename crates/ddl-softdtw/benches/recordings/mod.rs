//! Windows to measure with: of the real recordings where they are, of synthetic walkers otherwise.

#[path = "../../tests/recorded/mod.rs"]
mod recorded;
#[path = "../synthetic/mod.rs"]
pub(crate) mod synthetic;

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
                candidates: synthetic::walkers(37_000, steps..steps + 1, 2),
                queries: synthetic::walkers(400, steps..steps + 1, 3),
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
