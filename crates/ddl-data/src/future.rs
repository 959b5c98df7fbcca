//! Where pedestrians went after an observation.

use std::collections::BTreeMap;

use ddl_core::{HORIZON, OBSERVED, PedestrianId, Position, TIME_STEP, Window, between};

use crate::observation::Observation;
use crate::observe::ON_STEP;
use crate::recording::Recording;

/// Largest time between two rows (s) whose straight connection counts as the true path.
const JOINED: f64 = 1.2;

/// The true paths of the pedestrians of a recording.
#[derive(Debug)]
pub struct TruePaths<'a> {
    tracks: BTreeMap<PedestrianId, Vec<&'a Observation>>,
    frame_step: i64,
}

impl Recording {
    /// The true paths. A forecaster must not see them.
    ///
    /// ```
    /// use ddl_core::PedestrianId;
    /// use ddl_data::{LiveTracks, Observation, Recording};
    ///
    /// let walk = (0..10).map(|t| Observation::new(10 * t, PedestrianId(1), [t as f64, 0.0])).collect();
    /// let recording = Recording::new("yard", 10, walk)?;
    /// let first = &recording.observed_windows()[0];
    /// assert_eq!(recording.futures().after(first), [[[8.0, 0.0], [9.0, 0.0]]]);
    /// # Ok::<(), ddl_data::RecordingError>(())
    /// ```
    #[must_use]
    pub fn futures(&self) -> TruePaths<'_> {
        TruePaths { tracks: self.tracks(), frame_step: self.frame_step() }
    }
}

impl TruePaths<'_> {
    /// The positions of each pedestrian (m) every 0.4 s after an observed window, up to [`HORIZON`] of them: rows at
    /// these times, or points between rows at most 1.2 s apart. They end where there are no such rows.
    #[must_use]
    pub fn after(&self, window: &Window) -> Vec<Vec<Position>> {
        let last = window.frames()[OBSERVED - 1];
        let path = |pedestrian| {
            let track = self.tracks.get(pedestrian).map_or(&[][..], Vec::as_slice);
            let steps = 1..=HORIZON as i64;
            steps.map_while(|step| position_at(track, last + step * self.frame_step, self.frame_step)).collect()
        };
        window.pedestrians().iter().map(path).collect()
    }
}

/// The position of a track at a tick, of which `step` make 0.4 s: a row, or a point between rows.
pub(crate) fn position_at(track: &[&Observation], tick: i64, step: i64) -> Option<Position> {
    let after = track.partition_point(|row| row.frame < tick);
    let rows = [after.checked_sub(1).map(|before| track[before]), track.get(after).copied()];
    let off = |row: &&Observation| (row.frame - tick).abs();
    let nearest = rows.into_iter().flatten().min_by_key(off)?;
    if off(&nearest) as f64 <= ON_STEP * step as f64 {
        return Some(nearest.position);
    }
    let [Some(before), Some(after)] = rows else { return None };
    let apart = (after.frame - before.frame) as f64;
    let between = between(before.position, after.position, (tick - before.frame) as f64 / apart);
    (apart * TIME_STEP <= JOINED * step as f64).then_some(between)
}
