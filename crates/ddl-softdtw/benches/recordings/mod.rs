//! Windows for the benchmarks: of the real recordings if available, otherwise of synthetic pedestrians.

#[path = "../../tests/walks/mod.rs"]
pub(crate) mod walks;

use ddl_data::{Convention, Dataset, Recording, TIME_STEP, WindowRule, locate};

pub(crate) type Walk = Vec<[f64; 2]>;

/// The recording of the queries; candidates are from all others.
const QUERIES: &str = "eth";

pub(crate) struct Windows {
    pub(crate) source: &'static str,
    pub(crate) candidates: Vec<Walk>,
    pub(crate) queries: Vec<Walk>,
}

impl Windows {
    /// The first `steps` velocities (m/s) of all complete windows: those of one recording against those of seven
    /// others.
    pub(crate) fn load(steps: usize) -> Self {
        let Ok(folder) = locate(Convention::Star, None) else {
            let mut numbers = walks::Numbers(2);
            let mut synthetic = |count| (0..count).map(|_| numbers.pedestrian(steps)).collect();
            return Self {
                source: "synthetic",
                candidates: synthetic(37_000),
                queries: synthetic(400),
            };
        };
        let dataset = Dataset::load(Convention::Star, &folder).expect("recordings as published");
        let is_asked = |recording: &&Recording| recording.name() == QUERIES;
        let (asked, others): (Vec<_>, Vec<_>) = dataset.recordings().iter().partition(is_asked);
        let [queries, candidates] = [asked, others].map(|recordings| {
            let windows = recordings.into_iter().map(|r| windows(r, steps));
            windows.flatten().collect()
        });
        Self {
            source: "real",
            candidates,
            queries,
        }
    }

    pub(crate) fn some_queries(&self, count: usize) -> Vec<Walk> {
        let every = self.queries.len().div_ceil(count).max(1);
        self.queries.iter().step_by(every).cloned().collect()
    }
}

fn windows(recording: &Recording, steps: usize) -> Vec<Walk> {
    let windows = recording.windows(WindowRule::Complete);
    let tracks = windows.iter().flat_map(|w| (0..w.len()).map(|i| w.track(i)));
    tracks.map(|track| velocities(&track[..=steps])).collect()
}

/// Velocities (m/s) between consecutive positions (m).
fn velocities(positions: &[[f64; 2]]) -> Walk {
    let velocity = |pair: &[[f64; 2]]| [0, 1].map(|d| (pair[1][d] - pair[0][d]) / TIME_STEP);
    positions.windows(2).map(velocity).collect()
}
