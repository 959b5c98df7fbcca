//! Who walks together.

use ddl_core::{OBSERVED, Position, SpatialIndex, TIME_STEP, Window, distance};
use std::collections::BTreeMap;

/// Mean distance over the observation below which two may walk together, metres.
const CLOSE: f64 = 2.2;
/// Difference of their mean velocities below which they do, m/s.
const ALIKE: f64 = 0.35;
/// Each pedestrian is compared with at most this many others, the nearest ones.
const MOST_NEIGHBOURS: usize = 16;

/// Mean distance (m) of two observed tracks of 8 positions, and the difference of their mean velocities (m/s).
pub(crate) fn closeness(a: &[Position], b: &[Position]) -> [f64; 2] {
    let apart = a.iter().zip(b).map(|(p, q)| distance(*p, *q)).sum::<f64>() / a.len() as f64;
    let moved = |track: &[Position]| [0, 1].map(|axis| track[OBSERVED - 1][axis] - track[0][axis]);
    [apart, distance(moved(a), moved(b)) / (TIME_STEP * (OBSERVED - 1) as f64)]
}

/// Groups of at least two pedestrians of a window who walk together, as indices in ascending order: linked by pairs
/// whose mean distance over the observation is below 2.2 m and whose mean velocities differ by less than 0.35 m/s.
///
/// Two who stand beside each other count as a group, too; nobody who is hardly observed does.
#[must_use]
pub fn groups(window: &Window) -> Vec<Vec<usize>> {
    let present = window.positions_at(OBSERVED - 1);
    let index = SpatialIndex::new(&present);
    let mut links: Vec<usize> = (0..window.len()).collect();
    for (i, &place) in present.iter().enumerate() {
        for j in index.nearest_others(i, place, MOST_NEIGHBOURS) {
            if [i, j].iter().any(|&one| window.quality(one).is_hardly_observed()) {
                continue;
            }
            let [apart, velocities] = closeness(window.observed(i), window.observed(j));
            if apart < CLOSE && velocities < ALIKE {
                link(&mut links, i, j);
            }
        }
    }
    linked(&mut links).into_values().filter(|members| members.len() > 1).collect()
}

/// Links two members, and all who are linked to them; at first each is linked to itself.
pub(crate) fn link(links: &mut [usize], i: usize, j: usize) {
    let (a, b) = (first_of(links, i), first_of(links, j));
    links[a.max(b)] = a.min(b);
}

/// Who is linked, by the first of them, in ascending order.
pub(crate) fn linked(links: &mut [usize]) -> BTreeMap<usize, Vec<usize>> {
    let mut linked: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
    for i in 0..links.len() {
        linked.entry(first_of(links, i)).or_default().push(i);
    }
    linked
}

/// The first member of the group of pedestrian `i`; every link leads to an earlier member, and is shortened on the way.
fn first_of(links: &mut [usize], mut i: usize) -> usize {
    while links[i] != i {
        links[i] = links[links[i]];
        i = links[i];
    }
    i
}
