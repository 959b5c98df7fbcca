//! The clearance that pedestrians keep from each other.

use crate::error::DdlError;
use ddl_data::{HORIZON, Position, SpatialIndex};
use ddl_dynamics::{Ball, DynamicsError, ObstacleSchedule};
use nalgebra::Vector2;
use serde::{Deserialize, Serialize};

/// The distance that pedestrians keep from each other, from centre to centre (metres).
///
/// Every hypothesis is integrated again among the others. Each of them is a disc on its most likely path. Within
/// 0.4 m of a disc the pedestrian slides along it ([`AvoidingFlow`](ddl_dynamics::AvoidingFlow)).
///
/// # What is guaranteed
/// The distance to the goal still falls at every step. The clearance itself is not guaranteed: the others move, and a
/// pedestrian does not step aside when one of them walks into it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Clearance(f64);

/// The largest clearance (metres); a larger one is a mistake.
const MOST: f64 = 10.0;

impl Clearance {
    /// Pedestrians react within this distance of another's disc (metres). Chosen on validation recordings, see
    /// docs/stability.md.
    pub(crate) const MARGIN: f64 = 0.4;

    /// A clearance of `distance` metres from centre to centre; two pedestrians touch at 0.4 m.
    ///
    /// # Errors
    /// [`DdlError::Clearance`] unless the distance is positive and at most 10 m.
    pub fn new(distance: f64) -> Result<Self, DdlError> {
        if distance > 0.0 && distance <= MOST {
            Ok(Self(distance))
        } else {
            Err(DdlError::Clearance(distance))
        }
    }

    pub(crate) fn distance(self) -> f64 {
        self.0
    }
}

/// The most likely path of every pedestrian; the other pedestrians keep the clearance from it.
#[derive(Debug)]
pub(crate) struct Others {
    clearance: Clearance,
    likeliest: Vec<[Position; HORIZON]>,
    /// The positions of all pedestrians at the end of each step.
    places: Vec<SpatialIndex>,
}

impl Others {
    pub(crate) fn new(clearance: Clearance, likeliest: Vec<[Position; HORIZON]>) -> Self {
        let positions = |t: usize| -> Vec<Position> { likeliest.iter().map(|path| path[t]).collect() };
        Self {
            clearance,
            places: (0..HORIZON).map(|t| SpatialIndex::new(&positions(t))).collect(),
            likeliest,
        }
    }

    /// For each step, the discs that pedestrian `i` avoids on its way from `start` to `goal`.
    ///
    /// With d the first distance to the goal, which falls at every step, the pedestrian stays within 2 d of the start.
    /// A disc shortens a step that would use more than half of the gap to it, and no step is longer than d. Discs
    /// further than 4 d plus the margin from the start have no effect and are left out.
    pub(crate) fn near(
        &self,
        i: usize,
        start: Position,
        goal: Position,
    ) -> Result<ObstacleSchedule<f64, 2>, DynamicsError> {
        let distance = (goal[0] - start[0]).hypot(goal[1] - start[1]);
        let reach = 4.0 * distance + self.clearance.0 + Clearance::MARGIN;
        let step = |(t, places): (usize, &SpatialIndex)| {
            let mut near: Vec<usize> = places.within_box(start, reach).collect();
            near.sort_unstable();
            let others = near.into_iter().filter(|&j| j != i);
            let disc = |j: usize| Ball::new(Vector2::from(self.likeliest[j][t]), self.clearance.0);
            others.map(disc).collect()
        };
        let steps: Result<_, _> = self.places.iter().enumerate().map(step).collect();
        Ok(ObstacleSchedule::new(steps?))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ddl_dynamics::{ObstacleSource as _, State};

    #[test]
    fn the_others_are_at_their_positions_at_the_end_of_the_step() {
        let path = |x: f64| std::array::from_fn(|t| [x, t as f64]);
        let likeliest = vec![path(0.0), path(1.0), path(2.0), path(99.0)];
        let others = Others::new(Clearance::new(0.4).unwrap(), likeliest);
        let others = others.near(1, [1.0, 0.0], [1.0, 4.0]).unwrap();
        for step in 0..HORIZON {
            let state = State::new(Vector2::new(9.0, 9.0), step, 0.0);
            let centres: Vec<_> = others.obstacles(&state).iter().map(Ball::centre).collect();
            let now = step as f64;
            assert_eq!(centres, [&Vector2::new(0.0, now), &Vector2::new(2.0, now)]);
        }
    }
}
