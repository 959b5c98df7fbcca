//! Why a plan may not be what its author means.

use super::{LAST, Plan};
use crate::futures::Futures;
use ddl_core::{HORIZON, Position, TIME_STEP, distance};
use std::fmt::{Display, Formatter, Result};

/// No robot among people is faster, m/s.
const FASTEST: f64 = 12.0;
/// A plan in milliseconds moves so slowly, m/s.
const SLOWEST: f64 = 0.02;
/// A plan is among people within this distance, metres.
const AMONG: f64 = 3.0;
/// A plan farther than this from everybody is doubtful if it is among people with x and y exchanged, metres.
const ASIDE: f64 = 15.0;
/// A plan farther than this from everybody is doubtful, metres.
const FAR: f64 = 50.0;
/// A plan that starts farther than this from the pedestrian who follows it is doubtful, metres.
const FAR_EGO: f64 = 2.0;

/// Why a plan may not be what its author means. What is computed of it holds for the plan as given.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
#[expect(missing_docs, reason = "the texts describe the fields")]
pub enum PlanDoubt {
    /// No robot among people moves at this speed, m/s.
    Fast { speed: f64 },
    /// One row alone is within the forecast, and until the next one (s) the plan hardly moves.
    Slow { next: f64 },
    /// The larger radius (m) of a row, counted from 1, holds from a time (s) on when the forecast has ended.
    LateRadius { row: usize, time: f64, radius: f64 },
    /// The distance (m) of whoever is nearest at the moment from the plan over 4.8 s, and whether it is among people
    /// with x and y exchanged.
    Far { nearest: f64, is_exchanged: bool },
    /// The distance (m) of its start from the pedestrian who follows it, and whether it starts there with x and y
    /// exchanged.
    FarEgo { apart: f64, is_exchanged: bool },
}

impl PlanDoubt {
    /// The kind of the doubt, a word: who tells doubts once tells each kind once.
    pub fn kind(&self) -> &'static str {
        match self {
            Self::Fast { .. } => "fast plan",
            Self::Slow { .. } => "slow plan",
            Self::LateRadius { .. } => "late radius",
            Self::Far { .. } => "far plan",
            Self::FarEgo { .. } => "far ego",
        }
    }
}

impl Display for PlanDoubt {
    fn fmt(&self, to: &mut Formatter<'_>) -> Result {
        let exchanged = |is_exchanged: &bool| if *is_exchanged { "; are x and y exchanged?" } else { "" };
        match self {
            Self::Fast { speed } => {
                let unit = if *speed < 100.0 * FASTEST { "centimetres" } else { "millimetres" };
                write!(
                    to,
                    "moves at up to {speed:.0} m/s: are its positions in {unit}? give metres, and times in seconds"
                )
            }
            Self::Slow { next } => write!(
                to,
                "has no later row within the 4.8 s of forecasts, and moves at less than 2 cm/s to that at {next} s: \
                 are its times milliseconds? give seconds after the moment"
            ),
            Self::LateRadius { row, time, radius } => write!(
                to,
                "has the radius {radius} m in row {row}, which holds from its time on, and at {time} s forecasts have \
                 ended: give radii before 4.8 s"
            ),
            Self::Far { nearest, is_exchanged } => write!(
                to,
                "is {nearest:.0} m or more from everybody{}; give the positions of the tracks, in metres",
                exchanged(is_exchanged)
            ),
            Self::FarEgo { apart, is_exchanged } => write!(
                to,
                "starts {apart:.1} m from the pedestrian who follows it{}; give times in seconds after the moment, and \
                 the positions of the tracks",
                exchanged(is_exchanged)
            ),
        }
    }
}

impl Plan {
    /// What is doubtful of a plan among people at these places (m), one of whom may follow it.
    pub fn doubts(&self, people: &[Position], ego: Option<usize>) -> Vec<PlanDoubt> {
        let places: Vec<Position> = (0..=HORIZON).map(|step| self.at(TIME_STEP * step as f64).position).collect();
        let speeds = places.array_windows().map(|[from, to]| distance(*from, *to) / TIME_STEP);
        let speed = speeds.fold(0.0, f64::max);
        let others = people.iter().enumerate().filter(|(i, _)| Some(*i) != ego);
        let nearest = |swap: bool| {
            let place = |[x, y]: Position| if swap { [y, x] } else { [x, y] };
            let gaps = others.clone().flat_map(|(_, one)| places.iter().map(move |at| distance(place(*at), *one)));
            gaps.fold(f64::INFINITY, f64::min)
        };
        // Most plans are beside the first pedestrian that is looked at.
        let near = |one: &Position| places.iter().any(|at| distance(*at, *one) <= ASIDE);
        let is_near = others.clone().any(|(_, one)| near(one));
        let [far, far_if_exchanged] = if is_near { [0.0; 2] } else { [false, true].map(nearest) };
        let is_exchanged = far > ASIDE && far_if_exchanged < AMONG;
        let start = self.at(0.0).position;
        let from_ego = |start: Position| ego.map_or(0.0, |ego| distance(start, people[ego]));
        let [apart, apart_if_exchanged] = [start, [start[1], start[0]]].map(from_ego);
        let mut later = self.points.iter().filter(|point| point.time > 0.0);
        let moved = later.clone().find(|point| distance(start, point.position) > 0.0);
        let slow = moved.filter(|moved| distance(start, moved.position) < SLOWEST * moved.time);
        let slow = slow.filter(|_| later.all(|point| point.time > LAST));
        let most = self.largest_radius();
        let late = (1..).zip(&self.points).find(|(_, point)| !point.is_within() && point.radius > most);
        let doubts = [
            (speed > FASTEST).then_some(PlanDoubt::Fast { speed }),
            slow.map(|moved| PlanDoubt::Slow { next: moved.time }),
            late.map(|(row, point)| PlanDoubt::LateRadius { row, time: point.time, radius: point.radius }),
            ((far > FAR || is_exchanged) && far.is_finite()).then_some(PlanDoubt::Far { nearest: far, is_exchanged }),
            (apart > FAR_EGO).then_some(PlanDoubt::FarEgo { apart, is_exchanged: apart_if_exchanged <= FAR_EGO }),
        ];
        doubts.into_iter().flatten().collect()
    }
}

impl Futures {
    /// What is doubtful of a plan in this scene, which the pedestrian `ego` follows if there is one.
    pub fn doubts(&self, plan: &Plan, ego: Option<usize>) -> Vec<PlanDoubt> {
        let people: Vec<Position> = (0..self.pedestrians()).map(|i| self.present(i)).collect();
        plan.doubts(&people, ego)
    }
}
