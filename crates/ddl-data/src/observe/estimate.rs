//! The 8 positions of an observation, at the moment and every 0.4 s before.

use ddl_core::{OBSERVED, ObservationQuality, Position, TIME_STEP};

use crate::observe::motion::{MotionState, WalkModel};
use crate::observe::noise::USUAL;
use crate::observe::track::{ObservedTrack, TimedPosition};

/// Largest distance of a row from a step that it is taken for, in steps: 2 ms.
pub(crate) const ON_STEP: f64 = 0.005;
/// Least noise in an estimate between rows (m): people sway.
const SWAY: f64 = 0.01;

/// What was observed of a pedestrian at a moment.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct ObservedPositions {
    /// Positions (m), oldest first; the last is that of the moment.
    pub(crate) positions: [Position; OBSERVED],
    pub(crate) quality: ObservationQuality,
}

impl ObservedTrack {
    /// The observation at a time, not before the last row; both in ticks of `tick_time` seconds, of which `step` make
    /// 0.4 s. Rows at the steps pass unchanged unless the tracker is noisy. A single row is a pedestrian at one place,
    /// whose velocity is not known; so is the last row of a track that is too short for its speed. `None` if positions
    /// overflow.
    pub(crate) fn observed(&self, time: f64, step: f64, tick_time: f64) -> Option<ObservedPositions> {
        if self.is_too_fast(tick_time) {
            return self.begun_at_last_row().observed(time, step, tick_time);
        }
        let level = self.level();
        let tolerance = ON_STEP * step;
        let steps: [f64; OBSERVED] = std::array::from_fn(|place| time - (OBSERVED - 1 - place) as f64 * step);
        let on_steps = steps.map(|at| self.row_at(at, tolerance).filter(|_| level.is_trusted()));
        let mut positions = [[0.0; 2]; OBSERVED];
        let mut quality = ObservationQuality::default();
        if on_steps.iter().any(Option::is_none) {
            let WalkModel { noise, agility } = level.walk();
            let noise = noise.max(SWAY);
            let motions = self.motions_at(&steps, tick_time, WalkModel { noise, agility });
            positions = motions.map(|motion| motion.position);
            let clean = clean_motion(agility);
            let excess = |variance: f64, clean: f64| (variance - clean).max(0.0).sqrt();
            let last = &motions[OBSERVED - 1];
            quality = ObservationQuality {
                unseen: match self.rows.len() {
                    1 => OBSERVED - 1,
                    _ => steps.iter().filter(|&&at| at < self.rows[0].time - tolerance).count(),
                },
                age: (time - self.last_time()) * tick_time,
                deviation: excess(last.variance, clean.variance),
                velocity_deviation: excess(last.velocity_variance, clean.velocity_variance),
            };
        }
        for (position, row) in positions.iter_mut().zip(on_steps) {
            *position = row.map_or(*position, |row| row.position);
        }
        let finite = positions.as_flattened().iter().all(|coordinate| coordinate.is_finite());
        finite.then_some(ObservedPositions { positions, quality })
    }

    fn row_at(&self, time: f64, tolerance: f64) -> Option<&TimedPosition> {
        let after = self.rows.partition_point(|row| row.time < time - tolerance);
        let near = self.rows.range(after..).take_while(|row| row.time <= time + tolerance);
        near.min_by(|a, b| (a.time - time).abs().total_cmp(&(b.time - time).abs()))
    }

    /// The smoothed motion at ascending times.
    fn motions_at(&self, times: &[f64; OBSERVED], tick_time: f64, walk: WalkModel) -> [MotionState; OBSERVED] {
        let first = self.rows[0];
        let later = times.iter().filter(|time| **time > first.time).map(|&time| (time, None));
        let rows = self.rows.iter().map(|row| (row.time, Some(row.position)));
        let mut moments: Vec<(f64, Option<Position>)> = rows.chain(later).collect();
        // A row before a step at the same time.
        moments.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut motions = Vec::with_capacity(moments.len());
        let mut motion = MotionState::first_seen(first.position, walk);
        for (index, &(time, position)) in moments.iter().enumerate() {
            if index > 0 {
                motion = motion.expected_after((time - moments[index - 1].0) * tick_time);
                if let Some(position) = position {
                    motion = motion.corrected(position, walk.noise);
                }
            }
            motions.push(motion);
        }
        for index in (0..motions.len() - 1).rev() {
            let seconds = (moments[index + 1].0 - moments[index].0) * tick_time;
            motions[index] = motions[index].smoothed(&motions[index + 1], seconds);
        }
        times.map(|time| {
            if time <= first.time {
                return motions[0].expected_after((time - first.time) * tick_time);
            }
            let place = moments.partition_point(|moment| moment.0 <= time) - 1;
            motions[place]
        })
    }
}

/// The motion of a pedestrian so agile after a row of a usual tracker at each of the 8 steps.
fn clean_motion(agility: f64) -> MotionState {
    let walk = WalkModel { noise: USUAL, agility };
    let first = MotionState::first_seen([0.0; 2], walk);
    (1..OBSERVED).fold(first, |motion, _| motion.expected_after(TIME_STEP).corrected([0.0; 2], walk.noise))
}
