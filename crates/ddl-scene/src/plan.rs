//! The plan of a robot, or of anybody whose path is known.

mod doubt;

use crate::error::PlanError;
use ddl_core::{COORDINATE_LIMIT, HORIZON, Position, TIME_STEP, between};
pub use doubt::PlanDoubt;
use serde::{Deserialize, Serialize};

/// The end of a forecast, seconds after the moment.
const LAST: f64 = TIME_STEP * HORIZON as f64;

/// A row of a plan.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct PlanPoint {
    /// Seconds after the moment of the forecast.
    pub time: f64,
    /// Metres.
    pub position: Position,
    /// Radius of whoever follows the plan from this time on, metres; distances are measured from its edge.
    pub radius: f64,
}

impl PlanPoint {
    /// Whether it comes before the end of a forecast, up to rounding.
    fn is_within(&self) -> bool {
        self.time + 1e-9 < LAST
    }
}

/// A path over time, with straight lines between its rows; the radius of a row holds until the next one. Before its
/// first time it is at the first position, after its last time at the last position.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Plan {
    points: Vec<PlanPoint>,
}

impl Plan {
    /// A plan of these rows, in the order of time.
    ///
    /// # Errors
    /// There are no rows, a number is not finite, a radius is negative, the times do not ascend, or none of the plan is
    /// within 0 to 4.8 s.
    pub fn new(points: Vec<PlanPoint>) -> Result<Self, PlanError> {
        let [first, last] = [points.first(), points.last()].map(|point| point.map(|point| point.time));
        let (Some(first), Some(last)) = (first, last) else { return Err(PlanError::Empty) };
        for (row, point) in (1..).zip(&points) {
            let [x, y] = point.position;
            let numbers = [("time", point.time), ("x", x), ("y", y), ("radius", point.radius)];
            let wrong = |number: Option<&(&'static str, f64)>, more| {
                number.map_or(Ok(()), |&(field, value)| Err(PlanError::Number { row, field, value, more }))
            };
            wrong(numbers.iter().find(|(_, number)| !number.is_finite()), "")?;
            let mut places = numbers[1..].iter();
            let far = places.find(|(_, number)| number.abs() > COORDINATE_LIMIT);
            wrong(far, " of at most 1e7 m in size")?;
            wrong(numbers[3..].iter().find(|(_, radius)| *radius < 0.0), ", at least 0")?;
        }
        for (row, pair) in (2..).zip(points.windows(2)) {
            let [before, time] = [pair[0].time, pair[1].time];
            if time <= before {
                return Err(PlanError::Order { row, time, before });
            }
        }
        if last < 0.0 || first > LAST {
            return Err(PlanError::OutOfHorizon { first, last });
        }
        Ok(Self { points })
    }

    /// Its rows.
    pub fn points(&self) -> &[PlanPoint] {
        &self.points
    }

    /// Where it is at a time (s), with its radius there.
    pub fn at(&self, time: f64) -> PlanPoint {
        let next = self.points.partition_point(|point| point.time <= time);
        let from = self.points[next.saturating_sub(1)];
        let to = self.points[next.min(self.points.len() - 1)];
        let share =
            if to.time > from.time { ((time - from.time) / (to.time - from.time)).clamp(0.0, 1.0) } else { 0.0 };
        PlanPoint { time, position: between(from.position, to.position, share), radius: from.radius }
    }

    /// The largest radius that holds within 4.8 s, metres.
    pub(crate) fn largest_radius(&self) -> f64 {
        let later = self.points.iter().filter(|point| point.time > 0.0 && point.is_within());
        later.map(|point| point.radius).fold(self.at(0.0).radius, f64::max)
    }
}

#[cfg(test)]
mod tests;
