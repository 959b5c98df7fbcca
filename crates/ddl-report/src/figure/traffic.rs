//! Counts of tracks: how many cross each square of a place, begin in it and end in it.

use ddl_core::Position;
use std::collections::BTreeMap;

/// Two positions farther apart (m) are not joined: the track has a gap between them.
const LONGEST_STEP: f64 = 1.5;

/// A square of the ground, by its index from the origin.
pub(super) type Square = [i64; 2];

/// Tracks that begin and that end in a square.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(super) struct Ends {
    pub(super) begun: usize,
    pub(super) ended: usize,
}

/// Counts of tracks by square.
#[derive(Debug)]
pub(super) struct Traffic {
    /// Side of the squares of crossing tracks (m); the squares of ends are twice as large.
    pub(super) side: f64,
    /// Tracks that cross a square; a track that returns counts once.
    pub(super) crossed: BTreeMap<Square, usize>,
    pub(super) ends: BTreeMap<Square, Ends>,
}

impl Traffic {
    pub(super) fn of(tracks: &[Vec<Position>], side: f64) -> Self {
        let mut last_track = BTreeMap::new();
        let mut crossed = BTreeMap::new();
        let mut ends: BTreeMap<Square, Ends> = BTreeMap::new();
        for (number, track) in tracks.iter().enumerate() {
            let mut cross = |place: Position| {
                let square = square(place, side);
                if last_track.insert(square, number) != Some(number) {
                    *crossed.entry(square).or_insert(0) += 1;
                }
            };
            for (step, &place) in track.iter().enumerate() {
                cross(place);
                if let Some(&next) = track.get(step + 1) {
                    between(place, next, side).for_each(&mut cross);
                }
            }
            if let [first, .., last] = &track[..] {
                ends.entry(square(*first, 2.0 * side)).or_default().begun += 1;
                ends.entry(square(*last, 2.0 * side)).or_default().ended += 1;
            }
        }
        Self { side, crossed, ends }
    }
}

/// Points on the straight line between two positions. They are so dense that a square is missed only if the line cuts
/// its corner.
fn between(from: Position, to: Position, side: f64) -> impl Iterator<Item = Position> {
    let apart = (to[0] - from[0]).hypot(to[1] - from[1]);
    let parts = if apart <= LONGEST_STEP { (8.0 * apart / side).ceil() as u32 } else { 0 };
    (1..parts).map(move |part| {
        let share = f64::from(part) / f64::from(parts);
        [0, 1].map(|axis| from[axis] + share * (to[axis] - from[axis]))
    })
}

fn square(place: Position, side: f64) -> Square {
    place.map(|metres| (metres / side).floor() as i64)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn who_stands_or_comes_back_counts_once_and_a_hole_is_not_crossed() {
        let there: Vec<Position> = (0..20).map(|t| [0.25 + 0.5 * f64::from(t), 0.1]).collect();
        let back: Vec<Position> = there.iter().rev().copied().collect();
        let stands = vec![[0.1, 0.1]; 30];
        let with_hole = vec![[0.1, 0.1], [3.1, 0.1]];
        let tracks = [[there.clone(), back].concat(), stands, with_hole];
        let traffic = Traffic::of(&tracks, 0.5);
        let crossed = |x| traffic.crossed.get(&[x, 0]).copied();
        assert_eq!((crossed(0), crossed(6), crossed(3)), (Some(3), Some(2), Some(1)));
        assert_eq!(traffic.crossed.len(), 20);
        let [begun, ended] = [3, 2];
        assert_eq!(traffic.ends[&[0, 0]], Ends { begun, ended });
        assert_eq!(traffic.ends[&[3, 0]], Ends { begun: 0, ended: 1 });
    }
}
