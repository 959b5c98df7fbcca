//! Pedestrians whose velocity is hardly known, because they are seen for the first time. Their goals come from how far
//! people go, in any direction, and from where earlier pedestrians of the place went.

use crate::goals::model::failed;
use crate::goals::reach;
use ddl_core::{ForecastError, HORIZON, OBSERVED, Position, TIME_STEP, Window};
use ddl_goal::{GoalSet, HeadingFrame};
use std::borrow::Cow;
use std::f64::consts::TAU;

/// How far (m) people go in 4.8 s: the middles of twenty equal parts of them (`docs/method.md`, seen for the first
/// time).
const WAYS: [f64; 20] = [
    0.04, 0.23, 0.38, 0.72, 2.05, 3.45, 4.03, 4.36, 4.6, 4.84, 5.05, 5.27, 5.51, 5.77, 6.03, 6.32, 6.61, 6.92, 7.39,
    8.22,
];
/// Directions of each way.
const DIRECTIONS: usize = 20;
/// The directions of a way are turned from those of the one before by the golden ratio of the angle between two.
const TURN: f64 = 0.618_034;
/// Distance (m) at which an earlier pedestrian of the place counts less by a factor e; one at the same position counts
/// as much as all the ways.
const NEAR: f64 = 1.0;
/// Variance of a coordinate of the velocity that an observation begins with ((m/s)²).
const ANY_VELOCITY: f64 = 2.0;

/// The windows with the pedestrians whose motion is known.
#[derive(Debug)]
pub(crate) struct KnownMotions<'a> {
    windows: Cow<'a, [Window]>,
    /// `[window][pedestrian]`, of all pedestrians.
    is_known: Vec<Vec<bool>>,
}

impl<'a> KnownMotions<'a> {
    pub(crate) fn of(windows: &'a [Window]) -> Self {
        let of_window = |window: &Window| (0..window.len()).map(|i| !window.quality(i).is_hardly_observed()).collect();
        let is_known: Vec<Vec<bool>> = windows.iter().map(of_window).collect();
        let windows = if is_known.iter().flatten().all(|&known| known) {
            Cow::Borrowed(windows)
        } else {
            let pairs = windows.iter().zip(&is_known);
            pairs.filter_map(|(window, known)| window.filter_pedestrians(|i| known[i])).collect()
        };
        Self { windows, is_known }
    }

    /// Whether all pedestrians are among them.
    pub(crate) fn are_all(&self) -> bool {
        matches!(self.windows, Cow::Borrowed(_))
    }

    /// The windows without the others, who change no forecast of theirs; those of nobody are left out.
    pub(crate) fn windows(&self) -> &[Window] {
        &self.windows
    }

    /// The values `[window][pedestrian]` of the pedestrians of [`windows`](Self::windows), of those of all.
    pub(crate) fn only<T: Clone>(&self, of_all: &[Vec<T>]) -> Vec<Vec<T>> {
        let of_window = |(values, known): (&Vec<T>, &Vec<bool>)| -> Vec<T> {
            values.iter().zip(known).filter(|(_, known)| **known).map(|(value, _)| value.clone()).collect()
        };
        let of_windows = of_all.iter().zip(&self.is_known).map(of_window);
        of_windows.filter(|values| !values.is_empty()).collect()
    }

    /// The values `[window][pedestrian]` of all pedestrians: those of the known in order, `other(window, pedestrian)`
    /// of the others.
    pub(crate) fn with_others<T>(
        &self,
        of_known: impl IntoIterator<Item = T>,
        other: impl Fn(usize, usize) -> T,
    ) -> Vec<Vec<T>> {
        let mut of_known = of_known.into_iter();
        let of_window = |(window, known): (usize, &Vec<bool>)| {
            let values = known.iter().enumerate();
            values.filter_map(|(i, known)| if *known { of_known.next() } else { Some(other(window, i)) }).collect()
        };
        self.is_known.iter().enumerate().map(of_window).collect()
    }
}

/// At most `clusters` goals of a pedestrian of the window whose velocity is hardly known, within its reach.
pub(crate) fn goals(window: &Window, i: usize, clusters: usize) -> Result<GoalSet, ForecastError> {
    let observed = window.observed(i);
    let frame = HeadingFrame::new(observed).map_err(failed)?;
    let angle = |ring: usize, k: usize| (k as f64 + TURN * ring as f64) * TAU / DIRECTIONS as f64;
    let of_way = |(ring, way): (usize, f64)| {
        (0..DIRECTIONS).map(move |k| (<[f64; 2]>::from(angle(ring, k).sin_cos()).map(|share| way * share), 1.0))
    };
    let everywhere = WAYS.into_iter().enumerate().flat_map(of_way);
    let here = window.remembered(i).iter().map(|other| {
        let [from, to] = [OBSERVED, OBSERVED + HORIZON].map(|end| other.track[end - 1]);
        let end = frame.to_frame([0, 1].map(|axis| observed[OBSERVED - 1][axis] + to[axis] - from[axis]));
        (end, (WAYS.len() * DIRECTIONS) as f64 * (-other.distance / NEAR.powi(2)).exp())
    });
    // Bayes' rule: the mean velocity to an end is that of the observation, which began with any velocity.
    let variance = window.quality(i).velocity_deviation.powi(2);
    let seen = frame.to_frame(observed[OBSERVED - 2]).map(|coordinate| -coordinate / TIME_STEP);
    let likelihood = |end: Position| {
        let [x, y] = end.map(|coordinate| coordinate / (HORIZON as f64 * TIME_STEP));
        let precision = (1.0 / variance - 1.0 / ANY_VELOCITY).max(0.0);
        (x * seen[0] + y * seen[1]) / variance - precision * (x * x + y * y) / 2.0
    };
    let ends: Vec<(Position, f64)> = everywhere.chain(here).collect();
    let most = ends.iter().map(|(end, _)| likelihood(*end)).fold(f64::NEG_INFINITY, f64::max);
    let weighted = ends.into_iter().map(|(end, weight)| (end, weight * (likelihood(end) - most).exp()));
    let (ends, weights): (Vec<Position>, Vec<f64>) = weighted.unzip();
    let set = GoalSet::from_endpoints(&frame, &ends, &weights, clusters).map_err(failed)?;
    Ok(reach::clamped(set, observed, TIME_STEP))
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a test may panic")]

    use super::*;
    use ddl_core::{ObservationQuality, PedestrianId, RememberedTrack};

    /// The mean way to the goals of somebody at (5, 2) with this velocity, known so well, and these earlier
    /// pedestrians, who passed so far from there and went on by so much in 4.8 s.
    fn way(velocity: f64, velocity_deviation: f64, earlier: &[(f64, Position)]) -> Position {
        let track = (0..8).map(|t| [5.0 + 0.4 * velocity * (f64::from(t) - 7.0), 2.0]).collect();
        let quality = ObservationQuality { unseen: 7, velocity_deviation, ..ObservationQuality::default() };
        let window = Window::new("yard", 0, 1, vec![PedestrianId(3)], vec![track]).unwrap();
        let remembered = |&(aside, to): &(f64, Position)| RememberedTrack {
            track: std::array::from_fn(|t| [0, 1].map(|axis| to[axis] * (t as f64 - 7.0) / 12.0)),
            distance: aside * aside,
        };
        let window = window.with_qualities(vec![quality]);
        let window = window.with_remembered(|_| earlier.iter().map(remembered).collect());
        let goals = goals(&window, 0, 20).unwrap();
        let sum = |axis: usize| goals.goals().iter().zip(goals.weights()).map(|(goal, w)| w * goal[axis]).sum::<f64>();
        [sum(0) - 5.0, sum(1) - 2.0]
    }

    /// The better the velocity of 1.2 m/s is known, the nearer the goals are to 5.8 m ahead. One who passed at the same
    /// position counts as much as all that is known elsewhere, and each metre from there takes a factor.
    #[test]
    fn velocity_and_place_show_the_way() {
        let ahead = [1.4, 0.8, 0.5, 0.32].map(|deviation| way(1.2, deviation, &[])[0]);
        assert!(ahead.is_sorted() && ahead[0] > 1.0 && (5.0..6.0).contains(&ahead[3]), "{ahead:?}");
        let nowhere = way(0.0, 1.41, &[]);
        assert!(nowhere[0].hypot(nowhere[1]) < 0.2, "{nowhere:?}");
        for (aside, share) in [(0.0, 0.5), (1.0, 1.0 / (1.0 + 1_f64.exp())), (6.0, 0.0)] {
            let [x, y] = way(0.0, 1.41, &[(aside, [0.0, -6.0])]);
            assert!((y + 6.0 * share).abs() < 0.3 && x.abs() < 0.3, "{aside}: {x} {y}");
        }
        let many = way(0.0, 1.41, &[(0.0, [-4.0, 4.0]); 9]);
        assert!((many[0] + 3.6).abs() < 0.3 && (many[1] - 3.6).abs() < 0.3, "{many:?}");
    }
}
