//! The pedestrian of a forecast, its frames, and the numbers of its hypotheses. Equal numbers are one joint future of
//! the scene.

use ddl_core::{HORIZON, OBSERVED, PedestrianName, Window};
use ddl_data::Problem;

use crate::protocol::Protocol;

#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct PedestrianKey {
    pub(super) recording: Option<String>,
    pub(super) observed_until: i64,
    pub(super) pedestrian: PedestrianName,
}

impl PedestrianKey {
    pub(super) fn named(&self) -> String {
        named(self.recording.as_deref(), self.observed_until, &self.pedestrian)
    }

    pub(super) fn too_many_hypotheses(&self) -> String {
        let (pedestrian, allowed) = (self.named(), Protocol::MAX_HYPOTHESES);
        format!(
            "more than {allowed} hypotheses of {pedestrian}; the protocols allow {allowed}: choose them without the \
             true future"
        )
    }
}

pub(super) fn named(recording: Option<&str>, observed_until: i64, pedestrian: &PedestrianName) -> String {
    let recording = recording.map_or_else(String::new, |name| format!("`{name}` "));
    format!("{recording}observed until {observed_until} pedestrian {pedestrian}")
}

pub(super) fn last_observed(window: &Window) -> i64 {
    window.frames()[OBSERVED - 1]
}

/// The forecast frames of a window: its own frames, and those at its regular step. They differ if the recording has
/// gaps.
pub(super) fn frames_ahead(window: &Window) -> [Vec<i64>; 2] {
    let (last, step) = (last_observed(window), window.frame_step());
    let regular: Vec<i64> = (1..=HORIZON as i64).map(|t| last + t * step).collect();
    let annotated = match &window.frames()[OBSERVED..] {
        [] => regular.clone(),
        frames => frames.to_vec(),
    };
    [annotated, regular]
}

pub(super) fn wrong_frames(found: &[i64], expected: &[i64]) -> String {
    let (found, expected) = (in_short(found), in_short(expected));
    format!("the forecast has the frames {found}; the 12 after the last observed one are {expected}")
}

fn in_short(frames: &[i64]) -> String {
    match frames {
        [] => "none".to_owned(),
        [one] => one.to_string(),
        [first, second] => format!("{first}, {second}"),
        [first, second, .., last] => format!("{first}, {second} to {last}"),
    }
}

/// The first number of the hypotheses of a file, known after its first pedestrian.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct HypothesisNumbering {
    first: Option<i64>,
}

impl HypothesisNumbering {
    /// Checks that sorted numbers are 0 ... K - 1 or 1 ... K, alike for all pedestrians of the file.
    pub(super) fn check(&mut self, sorted: &[i64], pedestrian: &str) -> Result<(), Problem> {
        let counts_from = |first: i64| sorted.iter().copied().eq((first..).take(sorted.len()));
        let first = match self.first {
            Some(first) => Some(first).filter(|&first| counts_from(first)),
            None => [0, 1].into_iter().find(|&first| counts_from(first)),
        };
        if first.is_some() {
            self.first = first;
            return Ok(());
        }
        let last = sorted.len() as i64 - 1;
        let expected = match self.first {
            Some(first) => format!("{} as before", range(first, first + last)),
            None => format!("{} or {}", range(0, last), range(1, 1 + last)),
        };
        let numbers: Vec<String> = sorted.iter().map(i64::to_string).collect();
        Err(format!(
            "the hypotheses of {pedestrian} have the numbers {}, expected {expected}; a number stands for one joint \
             future, so number them alike for all pedestrians",
            numbers.join(", ")
        )
        .into())
    }
}

fn range(first: i64, last: i64) -> String {
    if first == last { first.to_string() } else { format!("{first} to {last}") }
}
