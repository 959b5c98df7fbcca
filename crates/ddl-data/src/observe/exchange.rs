//! Exchanges of ids: pedestrians seen where others were expected.

use ddl_core::{PedestrianId, Position, distance};

use crate::observe::noise::log_likelihood;
use crate::observe::track::Expectation;

/// Log-likelihood of an exchange, before the rows: one of some hundreds.
const EXCHANGE: f64 = -5.0;
/// Evidence from which on an exchange is one of two explanations.
const POSSIBLE: f64 = -4.0;
/// A row is surprising from so many standard deviations on.
const SURPRISING: f64 = 2.5;
/// With more surprising positions in a frame these have another cause, such as a wrong rate.
const MOST: usize = 100;

/// A pedestrian whose row goes on from the track of another.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Exchange {
    pub(crate) id: PedestrianId,
    /// Whose track it goes on from.
    pub(crate) from: PedestrianId,
    /// Distance from where it was expected (m).
    pub(crate) distance: f64,
    /// Log-likelihood of the exchange less that of its absence.
    pub(crate) evidence: f64,
}

/// A row whose pedestrian was expected elsewhere.
#[derive(Debug)]
struct Surprise {
    id: PedestrianId,
    position: Position,
    expected: Expectation,
}

impl Surprise {
    fn off(&self, expected: &Expectation) -> f64 {
        distance(self.position, expected.position)
    }

    /// Log-likelihood by which it goes on from the track of another rather than its own.
    fn goes_on_from(&self, other: &Self) -> f64 {
        let at = |expected| log_likelihood(self.off(expected), expected.deviation * expected.deviation);
        at(&other.expected) - at(&self.expected)
    }
}

/// The pedestrians of a frame who exchanged their ids, or may have: in pairs, or round in a cycle.
pub(crate) fn exchanges(rows: impl Iterator<Item = (PedestrianId, Position, Expectation)>) -> Vec<Exchange> {
    let surprises = rows.filter_map(|(id, position, expected)| {
        let surprise = Surprise { id, position, expected };
        (surprise.off(&surprise.expected) > SURPRISING * surprise.expected.deviation).then_some(surprise)
    });
    let surprises: Vec<Surprise> = surprises.take(MOST + 1).collect();
    if surprises.len() > MOST {
        return Vec::new();
    }
    let gain = |i: usize, j: usize| surprises[i].goes_on_from(&surprises[j]);
    let best = |i: usize| {
        let others = (0..surprises.len()).filter(|&j| j != i && gain(i, j) > 0.0);
        others.max_by(|&a, &b| gain(i, a).total_cmp(&gain(i, b)))
    };
    let from: Vec<Option<usize>> = (0..surprises.len()).map(best).collect();
    let mut exchanges = Vec::new();
    for start in 0..surprises.len() {
        // The cycle from its first pedestrian on, if there is one.
        let next = |&i: &usize| from[i].filter(|&j| j != start);
        let cycle: Vec<usize> = std::iter::successors(Some(start), next).take(surprises.len()).collect();
        let is_closed = cycle.last().is_some_and(|&last| from[last] == Some(start));
        let pairs = || cycle.iter().filter_map(|&i| Some((i, from[i]?)));
        let evidence = EXCHANGE + pairs().map(|(i, j)| gain(i, j)).sum::<f64>();
        if is_closed && evidence > POSSIBLE && cycle.iter().all(|&i| i >= start) {
            exchanges.extend(pairs().map(|(i, j)| {
                let one = &surprises[i];
                Exchange { id: one.id, from: surprises[j].id, distance: one.off(&one.expected), evidence }
            }));
        }
    }
    exchanges
}
