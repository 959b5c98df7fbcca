//! How an expert would have walked from where the observed walker is.

use crate::error::{GoalError, TrackError};
use crate::estimator::GoalEstimator;
use crate::expert::Expert;
use crate::library::TRACK_LENGTH;
use crate::motion::Motion;
use crate::params::RetrievalFrame;
use crate::span::QuerySpan;

impl GoalEstimator {
    /// The track of an expert carried over to the walker of `track`, as its end is for the goals: to be drawn, say.
    ///
    /// In [`RetrievalFrame::World`] it is moved to the walker's first position. In [`RetrievalFrame::Heading`] its deviation
    /// from repeating the last observed step is added to the walker's own last step, repeated.
    ///
    /// # Shapes
    /// `track`: as for [`GoalEstimator::estimate`]; the result has [`TRACK_LENGTH`] positions (m).
    ///
    /// # Errors
    /// As [`GoalEstimator::estimate`].
    ///
    /// # Panics
    /// When `expert` is not of this estimator's library.
    pub fn carry_over(
        &self,
        expert: &Expert,
        track: &[[f64; 2]],
    ) -> Result<Vec<[f64; 2]>, GoalError> {
        let (library, observed) = (self.library(), QuerySpan::Observed.positions());
        let other = &library.tracks()[expert.index];
        if track.len() < observed {
            let (found, needed) = (track.len(), observed);
            return Err(TrackError::TooShort { found, needed }.into());
        }
        if self.params().frame == RetrievalFrame::World {
            let moved = |p: &[f64; 2]| [0, 1].map(|d| track[0][d] + p[d] - other[0][d]);
            return Ok(other.iter().map(moved).collect());
        }
        let walker = Motion::new(track, library.time_step())?;
        let expert_motion = Motion::new(other, library.time_step())?;
        let mirror = if expert.mirrored { -1.0 } else { 1.0 };
        let horizon = (TRACK_LENGTH - observed) as f64;
        let carried = |(step, &position): (usize, &[f64; 2])| {
            let share = (step as f64 - (observed - 1) as f64) / horizon;
            let [ahead, left] = expert_motion.deviation(position, share);
            walker.place([ahead, mirror * left], share)
        };
        Ok(other.iter().enumerate().map(carried).collect())
    }
}
