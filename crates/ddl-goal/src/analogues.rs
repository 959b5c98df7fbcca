//! Goals from analogues: similar pedestrians in their own heading frames, and their endpoints.

use crate::choice::choose;
use crate::error::{GoalError, LibraryError, TrackError};
use crate::expert::Expert;
use crate::goal_set::GoalSet;
use crate::library::ExpertLibrary;
use crate::motion::RecentMotion;
use crate::motion_index::MotionIndex;
use crate::points::{Points, is_in_range};
use crate::span::QuerySpan;
use ddl_core::WINDOW;

/// Temperature of the weights, relative to the distance of the farthest analogue.
const TEMPERATURE: f64 = 0.4;
/// Squared difference of motions that is attributed to rounding.
const ROUNDING: f64 = 1e-9;
/// Steps of Lloyd's iteration. More steps would fit the goals to these analogues and not to the pedestrian.
const STEPS: usize = 3;
/// Experts of a goal set, the most similar ones.
const REPORTED_EXPERTS: usize = 100;

/// A library prepared for [`crate::RetrievalFrame::Heading`].
#[derive(Clone, Debug)]
pub(crate) struct Analogues {
    index: MotionIndex,
    /// Deviation of the endpoint of each track from repeating its last step, in its own frame (m).
    deviations: Vec<[f64; 2]>,
    time_step: f64,
}

impl Analogues {
    pub(crate) fn new(library: &ExpertLibrary) -> Result<Self, LibraryError> {
        let time_step = library.time_step;
        let prepared = library.of_each(|track| {
            let motion = RecentMotion::new(track, time_step)?;
            let deviation = motion.deviation(track[WINDOW - 1]);
            let index = WINDOW - 2;
            is_in_range(deviation)
                .then_some((motion.components, deviation))
                .ok_or(TrackError::VelocityOverflow { index })
        })?;
        let (components, deviations): (Vec<_>, Vec<_>) = prepared.into_iter().unzip();
        Ok(Self { index: MotionIndex::new(&components), deviations, time_step })
    }

    pub(crate) fn goals(&self, track: &[[f64; 2]], experts: usize, clusters: usize) -> Result<GoalSet, GoalError> {
        let motion = RecentMotion::new(track, self.time_step)?;
        let mut analogues = self.index.nearest(&motion.components, experts);
        let points = self.weighted_deviations(&analogues);
        let (goals, weights) = choose(&points, clusters, STEPS);
        let goals: Vec<_> = goals.iter().map(|&d| motion.place(d)).collect();
        if !goals.as_flattened().iter().all(|value| value.is_finite()) {
            let index = QuerySpan::Observed.velocities() - 1;
            return Err(TrackError::VelocityOverflow { index }.into());
        }
        analogues.truncate(REPORTED_EXPERTS);
        Ok(GoalSet::new(goals, weights, analogues))
    }

    /// Deviations of the analogues, weighted by similarity; the weights sum to 1.
    fn weighted_deviations(&self, analogues: &[Expert]) -> Points {
        let distance = |expert: Option<&Expert>| expert.map_or(0.0, |expert| expert.distance);
        let nearest = distance(analogues.first());
        let temperature = TEMPERATURE * distance(analogues.last()).max(ROUNDING);
        let likeness = |alike: &Expert| ((nearest - alike.distance) / temperature).exp();
        let mut points = Points::default();
        for alike in analogues {
            let [ahead, left] = self.deviations[alike.index];
            let left = if alike.mirrored { -left } else { left };
            points.push([ahead, left], likeness(alike));
        }
        let total: f64 = points.weight.iter().sum();
        for weight in &mut points.weight {
            *weight /= total;
        }
        points
    }
}
