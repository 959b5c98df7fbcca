//! Checks for implausible recordings.

use std::collections::BTreeMap;

use ddl_core::{PedestrianId, PedestrianName, Position, TIME_STEP, distance};
use serde::Serialize;
use thiserror::Error;

use crate::future::position_at;
use crate::observation::Observation;
use crate::recording::Recording;

/// Faster than a pedestrian walks (m/s). If half of the steps exceed this, the positions are probably in pixels, or the
/// steps are not 0.4 s.
const IMPLAUSIBLE: f64 = 2.6;
/// If the 90 % quantile of the walking speeds is below this (m/s), the frames are probably closer together than 0.4 s.
const CREEPING: f64 = 0.6;
/// Distance between first and last position (m) above which a track counts as walking.
const FAR: f64 = 2.0;
/// Speed (m/s) above which a step is taken for a jump of the track to another pedestrian: the fastest sprinters reach
/// 12 m/s.
const JUMP: f64 = 12.0;
/// Largest distance from the start (m) below which the positions are probably not in metres. Over [`MANY_STEPS`] steps
/// even a standing pedestrian moves more than this, and so does the noise of a tracker.
const STILL: f64 = 0.02;
const MANY_STEPS: usize = 20;
/// A track in metres that goes straight on at a steady speed for `MANY_STEPS` steps is faster than this (m/s).
const CRAWLING: f64 = 0.1;
/// Largest side (m) of an area in which three people stand but do not walk, and the share of it that is crossed
/// in a walk.
const NARROW: f64 = 1.5;
const CROSSED: f64 = 0.2;
const A_CROWD: usize = 3;
/// A tracker repeats its last detection where a track keeps one position for such a time (s) and then moves farther
/// than this (m). A warning is given from this share of such rows on.
const STAY: std::ops::RangeInclusive<f64> = 0.19..=1.25;
const MOVED: f64 = 0.2;
const OFTEN_REPEATED: f64 = 0.2;
/// Rows at (0, 0) for each measured step above which they are taken for missing positions.
const PLACEHOLDERS: f64 = 0.05;
/// Time without any motion (s) that people do not reach, even standing, and speed before it (m/s), of a frozen track.
const FROZEN: f64 = 4.0;
const WALKING: f64 = 0.3;
/// A warning is given from this share of missing positions on, counted between the first and last frame of each
/// pedestrian.
pub(crate) const OFTEN: f64 = 0.03;

/// A plausibility warning; its message says how to correct the recording. Speeds are in m/s, distances in m.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
#[expect(missing_docs, reason = "the messages say what the fields are")]
pub enum PlausibilityWarning {
    #[error("no pedestrian has positions a step of 0.4 s apart; give the frame rate, or the unit of the times")]
    NoSteps,
    #[error(
        "half of the steps{whose} are faster than {median:.1} m/s; are the positions in metres, and the rows of a \
         pedestrian 0.4 s apart?"
    )]
    Fast { median: f64, whose: &'static str },
    #[error(
        "nine in ten steps of walking pedestrians are slower than {brisk:.2} m/s; are the rows of a pedestrian 0.4 s \
         apart, or closer?"
    )]
    Slow { brisk: f64 },
    #[error(
        "{rows} rows of {pedestrians} pedestrians have the position (0, 0); if it stands for a missing position, \
         remove these rows"
    )]
    Placeholders { rows: usize, pedestrians: usize },
    #[error(
        "no pedestrian moves farther than {farthest:.3} m; are the positions in metres, or in degrees or kilometres?"
    )]
    Still { farthest: f64 },
    #[error(
        "pedestrians who go straight on are no faster than {speed:.5} m/s; are the positions in metres, or in degrees, \
         kilometres or shares of a picture (0 to 1)?"
    )]
    Crawling { speed: f64 },
    #[error(
        "all {pedestrians} pedestrians are within {side:.1} m, and walk through it; are the positions in metres, or in \
         shares of a picture (0 to 1) or kilometres?"
    )]
    Narrow { pedestrians: usize, side: f64 },
    #[error(
        "{:.0} % of the rows between the first and the last of each pedestrian are missing; positions there are \
         estimated",
        100.0 * .share
    )]
    Unseen { share: f64 },
    #[error(
        "{:.0} % of the rows of walking pedestrians repeat the previous position for up to 1.25 s, and then the \
         position jumps; if the tracker repeats its last detection, remove the repeated rows; if positions are \
         rounded, give more digits",
        100.0 * .share
    )]
    Repeated { share: f64 },
    #[error(
        "pedestrian {} jumps in the step that ends at {when}, {:.1} m/s; is one of its two positions wrong, or does \
         the track continue with another pedestrian?",
        .fastest.pedestrian,
        .fastest.speed
    )]
    Jump { fastest: Fastest, when: String },
    #[error(
        "the frame numbers begin again in the file ({count} x), so its parts lie over each other or far apart; make a \
         file of each"
    )]
    Restarted { count: usize },
    #[error(
        "tracks that walk and then repeat one position for 4 s or longer, to their end: {count}; does the tracker \
         repeat the last position of pedestrians that it has lost?"
    )]
    Frozen { count: usize },
    #[error("no pedestrian was tracked for 20 steps: these tracks cannot be used for training or evaluation")]
    NothingToLearnFrom,
}

#[derive(Debug, Clone, PartialEq, Serialize)]
/// The fastest step of a recording.
#[non_exhaustive]
pub struct Fastest {
    /// Its speed, m/s.
    pub speed: f64,
    /// The pedestrian that makes it.
    pub pedestrian: PedestrianName,
    /// The raw frame at which it ends.
    pub frame: i64,
}

pub(crate) struct Speeds {
    pub(crate) steps: usize,
    pub(crate) median: Option<f64>,
    pub(crate) fastest: Option<Fastest>,
    /// The 90 % quantile of the speeds of steps of tracks that walk, m/s.
    pub(crate) brisk: Option<f64>,
    /// The median of the same speeds, and the largest speed of a track that goes straight on.
    walking: Option<f64>,
    straight: Option<f64>,
    /// Largest distance between the first and last position of any pedestrian, m.
    pub(crate) farthest: f64,
    pub(crate) pedestrians: usize,
    /// The longer side of the area of all positions, m.
    pub(crate) side: f64,
    /// Share of rows that repeat the previous position, among tracks that walk.
    repeated: f64,
    /// Rows at the origin, and pedestrians with such rows.
    at_zero: [usize; 2],
}

impl Speeds {
    pub(crate) fn warning(&self) -> Option<PlausibilityWarning> {
        let (Some(median), Some(fastest)) = (self.median, &self.fastest) else {
            return Some(PlausibilityWarning::NoSteps);
        };
        let [rows, pedestrians] = self.at_zero;
        if pedestrians > 1 && rows as f64 > PLACEHOLDERS * self.steps as f64 {
            return Some(PlausibilityWarning::Placeholders { rows, pedestrians });
        }
        let speeds = [(Some(median), ""), (self.walking, " of walking pedestrians")];
        let mut speeds = speeds.into_iter().filter_map(|(speed, whose)| Some((speed?, whose)));
        let crosses = self.farthest > CROSSED * self.side;
        if self.farthest < STILL && self.steps >= MANY_STEPS {
            let farthest = self.farthest;
            Some(PlausibilityWarning::Still { farthest })
        } else if self.side < NARROW && self.pedestrians >= A_CROWD && self.steps >= MANY_STEPS && crosses {
            Some(PlausibilityWarning::Narrow { pedestrians: self.pedestrians, side: self.side })
        } else if let Some((median, whose)) = speeds.find(|(speed, _)| *speed > IMPLAUSIBLE) {
            Some(PlausibilityWarning::Fast { median, whose })
        } else if self.repeated > OFTEN_REPEATED {
            let share = self.repeated;
            Some(PlausibilityWarning::Repeated { share })
        } else if fastest.speed > JUMP {
            let (fastest, when) = (fastest.clone(), format!("frame {}", fastest.frame));
            Some(PlausibilityWarning::Jump { fastest, when })
        } else {
            let brisk = self.brisk.filter(|&brisk| brisk < CREEPING);
            let slow = brisk.map(|brisk| PlausibilityWarning::Slow { brisk });
            let straight = self.straight.filter(|speed| speed.max(median) < CRAWLING);
            slow.or(straight.map(|speed| PlausibilityWarning::Crawling { speed }))
        }
    }
}

impl Recording {
    /// The first warning about frame numbers and speeds in [the summary](Self::summary), computed without the rest of
    /// the summary.
    #[must_use]
    pub fn speed_warning(&self) -> Option<PlausibilityWarning> {
        restarted(self.restarts).or_else(|| self.speeds(&self.tracks()).warning())
    }

    pub(crate) fn speeds(&self, tracks: &BTreeMap<PedestrianId, Vec<&Observation>>) -> Speeds {
        let step = self.frame_step();
        let [low, high] = self.corners();
        let mut speeds: Vec<(f64, &Observation)> = Vec::new();
        let (mut walking, mut straight): (Vec<f64>, Option<f64>) = (Vec::new(), None);
        let (mut at_zero, mut repeated, mut walked) = ([0; 2], 0, 0);
        for track in tracks.values() {
            let zeros = track.iter().filter(|seen| seen.position.iter().all(|x| *x == 0.0)).count();
            if zeros > 1 {
                at_zero = [at_zero[0] + zeros, at_zero[1] + 1];
            }
            let first = speeds.len();
            speeds.extend(track.iter().filter_map(|seen| {
                let before = position_at(track, seen.frame - step, step)?;
                Some((speed(before, seen.position), *seen))
            }));
            let steady = straight_speed(track, &speeds[first..], step);
            straight = straight.into_iter().chain(steady).reduce(f64::max);
            if way(track) > FAR {
                (repeated, walked) = (repeated + repeats(track, step), walked + track.len());
                walking.extend(speeds[first..].iter().map(|(speed, _)| *speed));
            }
        }
        speeds.sort_by(|a, b| a.0.total_cmp(&b.0));
        walking.sort_by(f64::total_cmp);
        Speeds {
            steps: speeds.len(),
            median: speeds.get(speeds.len() / 2).map(|(speed, _)| *speed),
            fastest: speeds.last().map(|(speed, seen)| Fastest {
                speed: *speed,
                pedestrian: self.names().of(seen.pedestrian),
                frame: seen.frame,
            }),
            brisk: walking.get(walking.len() * 9 / 10).copied(),
            walking: walking.get(walking.len() / 2).copied(),
            straight,
            farthest: tracks.values().map(|track| way(track)).fold(0.0, f64::max),
            pedestrians: tracks.len(),
            side: (high[0] - low[0]).max(high[1] - low[1]),
            repeated: repeated as f64 / f64::max(1.0, walked as f64),
            at_zero,
        }
    }
}

pub(crate) fn restarted(count: usize) -> Option<PlausibilityWarning> {
    (count > 0).then_some(PlausibilityWarning::Restarted { count })
}

/// Number of rows that repeat the previous position before a jump (see [`STAY`]).
fn repeats(track: &[&Observation], step: i64) -> usize {
    let same = |a: &&Observation, b: &&Observation| a.position.map(f64::to_bits) == b.position.map(f64::to_bits);
    let stays: Vec<&[&Observation]> = track.chunk_by(same).collect();
    let brief = stays.array_windows().filter(|[stay, next]| {
        let seconds = (next[0].frame - stay[0].frame) as f64 * TIME_STEP / step as f64;
        STAY.contains(&seconds) && distance(stay[0].position, next[0].position) > MOVED
    });
    brief.map(|[stay, _]| stay.len() - 1).sum()
}

/// Whether a track walks, and then repeats one position to its end.
pub(crate) fn is_frozen(track: &[&Observation], step: i64) -> bool {
    let last = track[track.len() - 1];
    let same = |row: &&&Observation| row.position.map(f64::to_bits) == last.position.map(f64::to_bits);
    let frozen = track.iter().rev().take_while(same).count();
    let start = track[track.len() - frozen];
    let before = position_at(track, start.frame - step, step);
    let is_long = (last.frame - start.frame) as f64 * TIME_STEP >= FROZEN * step as f64;
    is_long && before.is_some_and(|before| speed(before, start.position) > WALKING)
}

/// The speed of a track (m/s) that goes straight on: at nearly all of its many steps about as fast as from its first
/// position to its last.
fn straight_speed(track: &[&Observation], steps: &[(f64, &Observation)], step: i64) -> Option<f64> {
    let seconds = (track[track.len() - 1].frame - track[0].frame) as f64 * TIME_STEP / step as f64;
    let mean = way(track) / seconds;
    let steady = steps.iter().filter(|(speed, _)| (0.5..=1.5).contains(&(speed / mean)));
    let is_long = steps.len() >= MANY_STEPS && seconds >= TIME_STEP * MANY_STEPS as f64;
    (is_long && 10 * steady.count() >= 9 * steps.len()).then_some(mean)
}

/// Distance between the first and last position of a track, m.
fn way(track: &[&Observation]) -> f64 {
    distance(track[0].position, track[track.len() - 1].position)
}

fn speed(from: Position, to: Position) -> f64 {
    distance(from, to) / TIME_STEP
}
