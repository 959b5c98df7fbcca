//! The rows of one pedestrian so far, without those that cannot be its own.

use std::collections::VecDeque;

use ddl_core::{OBSERVED, Position, between, distance as distance_between};

use crate::observe::doubt::{Doubt, Fit, WRONG};
use crate::observe::exchange::Exchange;
use crate::observe::misfit::MisfitTreatment;
use crate::observe::motion::MotionState;
use crate::observe::noise::{NoiseLevel, RecordingNoise, TrackNoise, log_likelihood};

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
/// Faster than this (m/s) a pedestrian is only believed after this time (s).
const BRISK: f64 = 3.5;
const SHORT: f64 = 0.35;
/// Least top speed (m/s), and factor and margin (m/s) from the own speed to the top speed, as in the `MotionBounds` of
/// `ddl-dynamics`.
const WALKING: f64 = 2.15;
const FASTER: [f64; 2] = [1.3, 0.45];
/// Time (s) for which the fastest speed counts.
const RECENT: f64 = 1.2;
/// Fastest pedestrian that is taken up again after a jump (m/s).
const FASTEST: f64 = 4.0;
/// Time (s) for which rows must go on from a jump, so that the track begins anew there.
const CONFIRMED: f64 = 0.3;
/// Time (s) of rows at wrong positions after which the last of them is believed.
const LONGEST_DOUBT: f64 = 1.0;
/// Steps before the observation whose rows still improve it.
const EARLIER: f64 = 4.0;

/// A position of a track at a time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct TimedPosition {
    /// In ticks.
    pub(crate) time: f64,
    pub(crate) position: Position,
}

/// Time without a row after which a track begins anew (s).
pub(crate) const LONGEST_GAP: f64 = 2.0;

/// Rows closer together (s) show nothing: the last one alone is kept. So at most 512 a second are kept, some 2,250.
const CLOSEST: f64 = 1.0 / 512.0;
/// Rows that are in doubt and kept.
const MOST_SUSPECTS: usize = 512;

/// The rows of one pedestrian up to now.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct ObservedTrack {
    /// Rows since the track began; never empty.
    pub(super) rows: VecDeque<TimedPosition>,
    pub(super) noise: TrackNoise,
    /// The fastest speed of late.
    pace: FastestSpeed,
    /// Another explanation of the last row.
    doubt: Option<Box<Doubt>>,
    /// Rows left out since the last one that was not: the beginning of another track?
    suspects: Vec<Suspect>,
}

#[derive(Debug, Clone, Copy, PartialEq)]
struct FastestSpeed {
    /// m/s.
    speed: f64,
    /// In ticks.
    time: f64,
}

#[derive(Debug, Clone, Copy, PartialEq)]
struct Suspect {
    row: TimedPosition,
    /// Distance from where the pedestrian was expected (m).
    distance: f64,
}

/// Where a pedestrian is expected.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Expectation {
    pub(crate) position: Position,
    /// Standard deviation of a coordinate of a row there (m).
    pub(crate) deviation: f64,
}

impl ObservedTrack {
    /// A track that begins.
    #[must_use]
    pub(crate) fn beginning(time: f64, position: Position) -> Self {
        let row = TimedPosition { time, position };
        Self {
            rows: [row].into(),
            noise: TrackNoise::of_first(position),
            pace: FastestSpeed { speed: 0.0, time },
            doubt: None,
            suspects: Vec::new(),
        }
    }

    /// A track that begins with the last row of this one.
    pub(super) fn begun_at_last_row(&self) -> Self {
        let row = self.rows[self.rows.len() - 1];
        Self::beginning(row.time, row.position)
    }

    /// Adds a row, later than the last, at a time in ticks of `tick_time` seconds. What it shows of the noise is added
    /// to `recording`. Returns the time of a row that is not where the pedestrian was expected (this one or the one
    /// before), how far off (m) it is, and how it is treated.
    pub(crate) fn push(
        &mut self,
        row: TimedPosition,
        tick_time: f64,
        recording: &mut RecordingNoise,
    ) -> Option<(f64, f64, MisfitTreatment)> {
        if (row.time - self.last_time()) * tick_time > LONGEST_GAP {
            *self = Self::beginning(row.time, row.position);
            return None;
        }
        let mut fit = self.fit(row, tick_time);
        let distance = fit.distance;
        let fits = (fit.is_expected || fit.is_turn) && !self.goes_on(row, distance, tick_time);
        let mut kept = None;
        if let Some(mut doubt) = self.doubt.take() {
            let other = doubt.other.fit(row, tick_time);
            fit = fit.nearer(self.after_doubtful(&doubt, row, tick_time));
            // This row may be the wrong one.
            let right = if fits { fit.likelihood.max(WRONG) } else { WRONG };
            let likelihood = doubt.evidence + other.likelihood;
            if other.is_expected && doubt.is_noticed() && likelihood > right {
                let misfit = (doubt.time, doubt.distance, doubt.treatment);
                doubt.other.take(row, other, tick_time, recording);
                *self = doubt.other;
                return Some(misfit);
            }
            if fits
                && other.likelihood > fit.likelihood
                && likelihood > WRONG
                && let Some(weight) = fit.doubt((row.time - self.last_time()) * tick_time)
            {
                // The row before is still the doubtful one.
                doubt.evidence = likelihood - right;
                doubt.other.accept(row, tick_time, &mut recording.clone());
                doubt.weight = doubt.weight.max(weight);
                self.suspects.clear();
                self.accept(row, tick_time, recording);
                self.doubt = Some(doubt);
                return None;
            }
            kept = Some(doubt);
        }
        if fits {
            self.take(row, fit, tick_time, recording);
            return None;
        }
        let (distance, treatment) = self.leave_out(row, distance, tick_time, recording);
        if treatment == MisfitTreatment::LeftOut {
            // Such a row decides nothing about the one before.
            self.doubt = kept;
        }
        Some((row.time, distance, treatment))
    }

    /// Takes a row that fits, perhaps with doubt.
    fn take(&mut self, row: TimedPosition, fit: Fit, tick_time: f64, recording: &mut RecordingNoise) {
        self.suspects.clear();
        let doubt = fit.doubt((row.time - self.last_time()) * tick_time).map(|weight| Doubt {
            other: self.clone(),
            evidence: fit.evidence(),
            weight,
            time: row.time,
            distance: fit.distance,
            treatment: MisfitTreatment::LeftOut,
        });
        self.accept(row, tick_time, recording);
        self.doubt = doubt.map(Box::new);
    }

    /// The track by another explanation of its last row, the weight of that, and whether it is the likelier one; `None`
    /// where the row is not doubtful.
    pub(crate) fn otherwise(&self) -> Option<(&Self, f64, bool)> {
        self.doubt.as_ref().map(|doubt| (&doubt.other, doubt.weight, doubt.is_likelier()))
    }

    /// Where the pedestrian is expected at a time; `None` if the last row is too old.
    pub(crate) fn expectation(&self, time: f64, tick_time: f64) -> Option<Expectation> {
        let seconds = (time - self.last_time()) * tick_time;
        let (expected, deviation) = self.expected_after(seconds);
        (seconds <= LONGEST_DOUBT).then_some(Expectation { position: expected.position, deviation })
    }

    /// Adds the row of a pedestrian who exchanged its id with that of another track, or may have: as [`push`](Self::push).
    pub(crate) fn exchange(
        &mut self,
        mut other: Self,
        Exchange { distance, evidence, .. }: Exchange,
        row: TimedPosition,
        tick_time: f64,
        recording: &mut RecordingNoise,
    ) -> Option<(f64, f64, MisfitTreatment)> {
        let treatment = MisfitTreatment::Exchanged;
        other.doubt = None;
        if evidence > 0.0 {
            *self = other;
            let misfit = self.push(row, tick_time, recording);
            return misfit.or(Some((row.time, distance, treatment)));
        }
        other.accept(row, tick_time, &mut recording.clone());
        let misfit = self.push(row, tick_time, recording);
        self.doubt = Some(Box::new(Doubt { other, evidence, weight: 0.5, time: row.time, distance, treatment }));
        misfit
    }

    /// The motion expected some seconds after the last row, and the standard deviation of a row from it (m).
    fn expected_after(&self, seconds: f64) -> (MotionState, f64) {
        let level = self.level();
        let expected = self.noise.motion(level).expected_after(seconds);
        let noise = level.walk().noise;
        (expected, (expected.variance + noise * noise).sqrt())
    }

    fn fit(&self, row: TimedPosition, tick_time: f64) -> Fit {
        let seconds = (row.time - self.last_time()) * tick_time;
        let (expected, deviation) = self.expected_after(seconds);
        let margin = DEVIATIONS * deviation;
        let distance = expected.distance(row.position);
        let own = self.pace.speed.max(expected.speed());
        // A speed not yet seen may be that of a runner.
        let [turning, fastest] = if self.rows.len() < SHOW_SPEED {
            [RUNNING; 2]
        } else {
            [(TURNING * own).min(RUNNING), WALKING.max(FASTER[0] * own + FASTER[1])]
        };
        let last = self.rows.back().map_or(row.position, |last| last.position);
        // The estimate lags behind a runner who starts.
        let ahead = self.ahead(row.time).filter(|_| self.rows.len() >= SHOW_SPEED);
        let off = ahead.map_or(distance, |ahead| distance.min(distance_between(ahead, row.position)));
        let likelihood = log_likelihood(off, deviation * deviation);
        let way = distance_between(last, row.position);
        let near = off <= SURPRISE + ACCELERATION * seconds * seconds + margin;
        Fit {
            distance,
            deviation,
            likelihood,
            is_expected: near && way <= SURPRISE + fastest * seconds + margin,
            is_turn: way <= turning * seconds + margin,
        }
    }

    /// Whether a row is nearer to the continuation of the last doubtful row than to the position expected of the track,
    /// which is `distance` (m) away.
    fn goes_on(&self, row: TimedPosition, distance: f64, tick_time: f64) -> bool {
        if distance <= SURPRISE {
            return false;
        }
        self.suspects.last().is_some_and(|suspect| {
            distance_between(self.carried(suspect.row, row.time, tick_time), row.position) < distance
        })
    }

    /// Where somebody seen elsewhere is at a time, who moves as this track is expected to.
    fn carried(&self, seen: TimedPosition, time: f64, tick_time: f64) -> Position {
        let [from, to] =
            [seen.time, time].map(|time| self.expected_after((time - self.last_time()) * tick_time).0.position);
        [0, 1].map(|axis| seen.position[axis] + to[axis] - from[axis])
    }

    /// How far (m) a row is from where the last ones lead that agree with the doubtful row: on a straight line, or on
    /// the way of the other explanation, beside it.
    fn after_doubtful(&self, doubt: &Doubt, row: TimedPosition, tick_time: f64) -> f64 {
        let straight = self.ahead(row.time).map_or(f64::INFINITY, |ahead| distance_between(ahead, row.position));
        let is_confirmed = (row.time - doubt.time) * tick_time >= CONFIRMED;
        match self.rows.back() {
            Some(&last) if is_confirmed && doubt.treatment == MisfitTreatment::LeftOut => {
                straight.min(distance_between(doubt.other.carried(last, row.time, tick_time), row.position))
            }
            _ => straight,
        }
    }

    /// The last two rows, extrapolated to a time.
    fn ahead(&self, time: f64) -> Option<Position> {
        let before = self.rows.get(self.rows.len().checked_sub(2)?)?;
        let last = self.rows.back()?;
        let share = (time - last.time) / (last.time - before.time);
        Some(between(before.position, last.position, 1.0 + share))
    }

    /// Leaves a row out, or begins anew where rows agree.
    fn leave_out(
        &mut self,
        row: TimedPosition,
        distance: f64,
        tick_time: f64,
        recording: &mut RecordingNoise,
    ) -> (f64, MisfitTreatment) {
        let follows = |before: &Suspect| {
            let seconds = (row.time - before.row.time) * tick_time;
            distance_between(row.position, before.row.position) <= SURPRISE + FASTEST * seconds
        };
        if !self.suspects.last().is_some_and(follows) {
            self.suspects.clear();
        }
        if self.suspects.len() >= MOST_SUSPECTS {
            self.suspects.pop();
        }
        self.suspects.push(Suspect { row, distance });
        let first = self.suspects[0];
        let is_confirmed = (row.time - first.row.time) * tick_time >= CONFIRMED;
        if !is_confirmed && (row.time - self.last_time()) * tick_time <= LONGEST_DOUBT {
            return (distance, MisfitTreatment::LeftOut);
        }
        let suspects = std::mem::take(&mut self.suspects);
        *self = Self::beginning(first.row.time, first.row.position);
        for suspect in &suspects[1..] {
            self.accept(suspect.row, tick_time, recording);
        }
        (first.distance, MisfitTreatment::BegunAnew)
    }

    /// Time of the last row that was not left out, in ticks.
    #[must_use]
    pub(crate) fn last_time(&self) -> f64 {
        self.rows.back().map_or(f64::NEG_INFINITY, |row| row.time)
    }

    /// The shorter of the last two times between rows, in ticks; 0 with fewer rows.
    pub(crate) fn usual_interval(&self) -> f64 {
        let times = |back: usize| Some(self.rows.get(self.rows.len().checked_sub(back)?)?.time);
        match (times(1), times(2), times(3)) {
            (Some(last), Some(before), Some(first)) => (last - before).min(before - first),
            _ => 0.0,
        }
    }

    /// Whether the track is too short to believe its speed: a wrong or noisy first row looks like a runner.
    pub(super) fn is_too_fast(&self, tick_time: f64) -> bool {
        let seconds = self.rows.front().map_or(0.0, |first| (self.last_time() - first.time) * tick_time);
        seconds < SHORT && self.noise.motion(self.level()).speed() > BRISK
    }

    pub(super) fn level(&self) -> NoiseLevel {
        self.noise.level()
    }

    /// Forgets rows that no observation at this time or later needs; a step has this many ticks.
    pub(crate) fn forget_before(&mut self, time: f64, step: f64) {
        let oldest = time - (OBSERVED as f64 - 1.0 + EARLIER) * step;
        // The last row before them shows where the pedestrian came from.
        while self.rows.get(1).is_some_and(|row| row.time <= oldest) {
            self.rows.pop_front();
        }
        if let Some(doubt) = &mut self.doubt {
            doubt.other.forget_before(time, step);
        }
    }

    /// Leaves out the last row, if it follows the one before too closely.
    fn leave_out_close(&mut self, tick_time: f64) {
        let mut times = self.rows.iter().rev().map(|row| row.time);
        if let (Some(last), Some(before)) = (times.next(), times.next())
            && (last - before) * tick_time < CLOSEST
        {
            self.rows.pop_back();
        }
    }

    fn accept(&mut self, row: TimedPosition, tick_time: f64, recording: &mut RecordingNoise) {
        self.noise.add(row.position, (row.time - self.last_time()) * tick_time, recording);
        self.leave_out_close(tick_time);
        self.rows.push_back(row);
        let speed = self.noise.motion(self.level()).speed();
        let is_old = (row.time - self.pace.time) * tick_time > RECENT;
        if is_old || speed >= self.pace.speed {
            self.pace = FastestSpeed { speed, time: row.time };
        }
    }
}
