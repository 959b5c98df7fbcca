//! The rows of one pedestrian so far, without those that cannot be its own.

use std::collections::VecDeque;

use ddl_core::{OBSERVED, Position, distance as distance_between};

use crate::observe::noise::{NoiseLevel, RecordingNoise, TrackNoise};

/// Distance between an expected and a true position that no noise explains (m) ...
const SURPRISE: f64 = 0.5;
/// ... besides what a pedestrian can change of its motion (half an acceleration, m/s²) ...
const ACCELERATION: f64 = 1.5;
/// ... and this many standard deviations.
const DEVIATIONS: f64 = 4.0;
/// A pedestrian may turn to any side at its speed, and a little more.
const TURNING: f64 = 1.1;
/// Fastest runner (m/s), and number of rows that show the speed of a pedestrian.
const RUNNING: f64 = 12.0;
const SHOW_SPEED: usize = 3;
/// Fastest pedestrian that is taken up again after a jump (m/s).
const FASTEST: f64 = 4.0;
/// Number of rows at wrong positions after which the last of them is believed.
const MOST_WRONG: usize = 3;
/// Steps before the observation whose rows still improve it.
const EARLIER: f64 = 4.0;

/// A position of a track at a time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Row {
    /// In ticks.
    pub(super) time: f64,
    pub(super) position: Position,
}

/// How a row fits to the earlier ones of its track.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Arrival {
    /// It is the first, or the first after a long gap.
    First,
    /// It is where the pedestrian was expected.
    Expected,
    /// It is left out: so many metres from where the pedestrian was expected.
    Wrong(f64),
    /// The row before it, thought to be wrong, was the first of a new track: so many metres from the old one.
    Jumped(f64),
}

impl Arrival {
    /// Time without a row after which a track begins anew (s).
    pub(crate) const LONGEST_GAP: f64 = 2.0;
}

/// The rows of one pedestrian up to now.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct ObservedTrack {
    /// Rows since the track began; never empty.
    pub(super) rows: VecDeque<Row>,
    pub(super) noise: TrackNoise,
    /// The last row, if it is far from where it was expected.
    suspect: Option<Suspect>,
}

#[derive(Debug, Clone, Copy, PartialEq)]
struct Suspect {
    row: Row,
    distance: f64,
    /// Number of suspects in a row.
    count: usize,
}

impl ObservedTrack {
    /// A track that begins.
    #[must_use]
    pub(crate) fn beginning(time: f64, position: Position) -> Self {
        let row = Row { time, position };
        Self {
            rows: [row].into(),
            noise: TrackNoise::of_first(position),
            suspect: None,
        }
    }

    /// Adds a row, later than the last, at a time in ticks of `tick_time` seconds.
    pub(crate) fn push(
        &mut self,
        time: f64,
        position: Position,
        tick_time: f64,
        recording: &mut RecordingNoise,
    ) -> Arrival {
        let row = Row { time, position };
        let seconds = (time - self.last_time()) * tick_time;
        if seconds > Arrival::LONGEST_GAP {
            *self = Self::beginning(time, position);
            return Arrival::First;
        }
        let level = self.level(recording);
        let expected = self.noise.motion(level).expected_after(seconds);
        let distance = expected.distance(position);
        let noise = level.walk().noise;
        let deviation = (expected.variance + noise * noise).sqrt();
        let noise_margin = DEVIATIONS * deviation;
        let surprise = distance - SURPRISE - ACCELERATION * seconds * seconds;
        // Who turns goes on from the last row at the speed that it had; a speed not yet seen may be that of a runner.
        let speed = if self.rows.len() < SHOW_SPEED {
            RUNNING
        } else {
            (TURNING * expected.speed()).min(RUNNING)
        };
        let last = self.rows.back().map_or(position, |row| row.position);
        let turned = distance_between(last, position) - speed * seconds;
        if surprise.min(turned) <= noise_margin {
            self.suspect = None;
            self.accept(row, tick_time, recording);
            return Arrival::Expected;
        }
        let before = self.suspect.replace(Suspect {
            row,
            distance,
            count: self.suspect.map_or(1, |suspect| suspect.count + 1),
        });
        let Some(before) = before else {
            return Arrival::Wrong(distance);
        };
        let apart = distance_between(position, before.row.position);
        let follows = apart <= SURPRISE + FASTEST * (time - before.row.time) * tick_time;
        if follows {
            *self = Self::beginning(before.row.time, before.row.position);
            self.accept(row, tick_time, recording);
            Arrival::Jumped(before.distance)
        } else if before.count + 1 >= MOST_WRONG {
            *self = Self::beginning(time, position);
            Arrival::Jumped(distance)
        } else {
            Arrival::Wrong(distance)
        }
    }

    /// Time of the last row that was not left out, in ticks.
    #[must_use]
    pub(crate) fn last_time(&self) -> f64 {
        self.rows.back().map_or(f64::NEG_INFINITY, |row| row.time)
    }

    pub(super) fn level(&self, recording: &RecordingNoise) -> NoiseLevel {
        self.noise.level(recording)
    }

    /// Forgets rows that no observation at this time or later needs; a step has this many ticks.
    pub(crate) fn forget_before(&mut self, time: f64, step: f64) {
        let oldest = time - (OBSERVED as f64 - 1.0 + EARLIER) * step;
        // The last row before them shows where the pedestrian came from.
        while self.rows.get(1).is_some_and(|row| row.time <= oldest) {
            self.rows.pop_front();
        }
    }

    fn accept(&mut self, row: Row, tick_time: f64, recording: &mut RecordingNoise) {
        let seconds = (row.time - self.last_time()) * tick_time;
        self.noise.add(row.position, seconds, recording);
        self.rows.push_back(row);
    }
}
