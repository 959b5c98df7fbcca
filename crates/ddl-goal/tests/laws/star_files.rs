//! Files of the `star` convention, read without the crate that knows formats, and goals measured on them.

use std::collections::BTreeMap;
use std::error::Error;
use std::path::Path;

use ddl_goal::GoalSet;

pub(crate) const RECORDINGS: [&str; 8] = [
    "eth",
    "hotel",
    "zara01",
    "zara02",
    "zara03",
    "students001",
    "students003",
    "uni_examples",
];

/// The 20 positions (m) of a pedestrian from a start frame on.
pub(crate) type StarWindows = BTreeMap<(i64, i64), Vec<[f64; 2]>>;

/// The tracks of one recording by pedestrian and frame.
pub(crate) struct StarTracks {
    pub(crate) step: i64,
    pub(crate) by_pedestrian: BTreeMap<i64, BTreeMap<i64, [f64; 2]>>,
}

impl StarTracks {
    /// Reads four lines: frame, pedestrian, y (m), x (m).
    pub(crate) fn read(folder: &Path, recording: &str) -> Result<Self, Box<dyn Error>> {
        let text = std::fs::read_to_string(folder.join(format!("{recording}.csv")))?;
        let numbers = |line: &str| line.split(',').map(|field| field.trim().parse()).collect();
        let lines = text.lines().map(numbers);
        let lines: Vec<Vec<f64>> = lines.collect::<Result<_, std::num::ParseFloatError>>()?;
        let [frames, pedestrians, ys, xs] = lines.as_slice() else {
            return Err(format!("{recording}.csv: {} lines, 4 expected", lines.len()).into());
        };
        let mut by_pedestrian: BTreeMap<i64, BTreeMap<i64, [f64; 2]>> = BTreeMap::new();
        for ((frame, pedestrian), (y, x)) in frames.iter().zip(pedestrians).zip(ys.iter().zip(xs)) {
            let track = by_pedestrian.entry(*pedestrian as i64).or_default();
            track.insert(*frame as i64, [*x, *y]);
        }
        let step = if recording == "eth" { 6 } else { 10 };
        Ok(Self {
            step,
            by_pedestrian,
        })
    }

    /// Every pedestrian with all 20 frames, from every start.
    pub(crate) fn complete_windows(&self) -> StarWindows {
        let mut windows = StarWindows::new();
        for (&pedestrian, track) in &self.by_pedestrian {
            for &start in track.keys() {
                let frames = (0..20).map(|i| start + i * self.step);
                let positions: Option<Vec<_>> = frames.map(|f| track.get(&f).copied()).collect();
                if let Some(positions) = positions {
                    windows.insert((start, pedestrian), positions);
                }
            }
        }
        windows
    }
}

/// Distance from the goal nearest the true end to it (m).
pub(crate) fn goal_error(goals: &GoalSet, track: &[[f64; 2]]) -> f64 {
    let goal = goals.goals()[goals.nearest(track[19])];
    (goal[0] - track[19][0]).hypot(goal[1] - track[19][1])
}
