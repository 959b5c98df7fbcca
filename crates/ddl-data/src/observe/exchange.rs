//! Exchanges of ids: two pedestrians seen where the other one was expected.

use ddl_core::{PedestrianId, Position, distance};

use crate::observe::track::Expectation;

/// An exchange explains the positions so many times as well as two sudden turns.
const BETTER: f64 = 4.0;
/// Somebody seen where another was expected may be so many times as far from there as noise explains, which is
/// estimated.
const THERE: f64 = 1.5;
/// With more surprising positions in a frame these have another cause, such as a wrong rate.
const MOST: usize = 100;

/// A row whose pedestrian was expected elsewhere.
#[derive(Debug)]
struct Surprise {
    id: PedestrianId,
    position: Position,
    expected: Expectation,
    off: f64,
}

/// The pedestrians of a frame who exchanged their ids, each with the distance from where it was expected (m).
pub(crate) fn exchanged(rows: impl Iterator<Item = (PedestrianId, Position, Expectation)>) -> Vec<(PedestrianId, f64)> {
    let surprises = rows.filter_map(|(id, position, expected)| {
        let off = distance(position, expected.position);
        (off > expected.reach).then_some(Surprise { id, position, expected, off })
    });
    let surprises: Vec<Surprise> = surprises.take(MOST + 1).collect();
    if surprises.len() > MOST {
        return Vec::new();
    }
    let is_there = |seen: &Surprise, other: &Surprise| {
        let off = distance(seen.position, other.expected.position);
        (off <= THERE * other.expected.reach).then_some(off)
    };
    let mut exchanged = Vec::new();
    for (index, one) in surprises.iter().enumerate() {
        let other = surprises[index + 1..].iter().find(|other| {
            is_there(one, other).zip(is_there(other, one)).is_some_and(|(a, b)| BETTER * (a + b) < one.off + other.off)
        });
        if let Some(other) = other {
            exchanged.extend([one, other].map(|surprise| (surprise.id, surprise.off)));
        }
    }
    exchanged
}
