//! Who walks together, and how near people come to each other.

use crate::energy::{Energy, closeness};
use ddl_core::{OBSERVED, Position, SpatialIndex, Window, distance};
use serde::{Deserialize, Serialize};
use std::collections::{BTreeMap, BTreeSet};

/// Mean distance over the observation below which two may walk together, metres.
const CLOSE: f64 = 2.2;
/// Difference of their mean velocities below which they do, m/s.
const ALIKE: f64 = 0.35;
/// Whoever was nearer to another during the observation lets others come near, metres.
const LET_NEAR: f64 = 0.6;
/// Who is around somebody, metres.
const AROUND: f64 = 5.0;
/// Each pedestrian is compared with at most this many others, the nearest ones.
const MOST_NEIGHBOURS: usize = 16;

/// Two pedestrians who walk together, or may.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub(crate) struct Tie {
    /// Their indices, ascending.
    pub(crate) pedestrians: [usize; 2],
    /// How strongly they belong together, divided among partners.
    pub(crate) strength: f32,
    /// The least distance (m) over the observation.
    pub(crate) kept: f64,
}

/// What the observation tells of people who are near each other: who walks together, and how closely they pass.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Company {
    /// Groups of pedestrians who walk together, as [`groups`].
    pub(crate) groups: Vec<Vec<usize>>,
    pub(crate) ties: Vec<Tie>,
    /// `[N]`: the share of the people around each who came within 0.6 m of another during the observation.
    pub(crate) crowding: Vec<f64>,
}

impl Company {
    pub(crate) fn of(window: &Window) -> Self {
        let energy = Energy::learned();
        let present = window.positions_at(OBSERVED - 1);
        let index = SpatialIndex::new(&present);
        let mut links: Vec<usize> = (0..window.len()).collect();
        let (mut kept, mut partners) = (vec![f64::INFINITY; window.len()], vec![0.0_f32; window.len()]);
        let is_known = |i: &usize| !window.quality(*i).is_hardly_observed();
        let near_of = |i: usize| {
            let near = index.nearest_others(i, present[i], MOST_NEIGHBOURS).into_iter();
            near.filter(|j| is_known(&i) && is_known(j)).collect()
        };
        let near: Vec<Vec<usize>> = (0..window.len()).map(near_of).collect();
        let pairs: BTreeSet<[usize; 2]> =
            near.iter().enumerate().flat_map(|(i, near)| near.iter().map(move |&j| [i.min(j), i.max(j)])).collect();
        let mut ties = Vec::new();
        for [i, j] in pairs {
            let [a, b] = [i, j].map(|one| window.observed(one));
            let least = least_distance(a, b);
            for one in [i, j] {
                kept[one] = kept[one].min(least);
            }
            let closeness = closeness(a, b);
            if closeness[0] < CLOSE && closeness[1] < ALIKE {
                link(&mut links, i, j);
            }
            let strength = energy.strength(closeness);
            if strength > 0.0 {
                partners[i] += 1.0;
                partners[j] += 1.0;
                ties.push(Tie { pedestrians: [i, j], strength, kept: least });
            }
        }
        for Tie { pedestrians, strength, .. } in &mut ties {
            let [a, b] = pedestrians.map(|one| partners[one]);
            *strength /= a.max(b).sqrt();
        }
        let groups = linked(&mut links).into_values().filter(|members| members.len() > 1).collect();
        let crowding = |i: usize| {
            let around = near[i].iter().copied().filter(|&j| distance(present[i], present[j]) < AROUND).chain([i]);
            let some = around.clone().filter(|&one| kept[one] < LET_NEAR).count() as f64;
            // As if two more were there, of whom a fourth does.
            (some + 0.5) / (around.count() as f64 + 2.0)
        };
        let crowding = (0..window.len()).map(crowding).collect();
        Self { groups, ties, crowding }
    }

    /// Of these pedestrians, each of whom has this new index; the others have none.
    pub(crate) fn of_pedestrians(&self, pedestrians: &[usize], place: impl Fn(&usize) -> Option<usize>) -> Self {
        let groups = self.groups.iter().map(|group| group.iter().filter_map(&place).collect::<Vec<usize>>());
        let tie = |tie: &Tie| {
            let [i, j] = [place(&tie.pedestrians[0])?, place(&tie.pedestrians[1])?];
            Some(Tie { pedestrians: [i.min(j), i.max(j)], ..*tie })
        };
        Self {
            groups: groups.filter(|group| group.len() > 1).collect(),
            ties: self.ties.iter().filter_map(tie).collect(),
            crowding: pedestrians.iter().map(|&i| self.crowding[i]).collect(),
        }
    }

    /// Whoever walks with a pedestrian, or may.
    pub(crate) fn with(&self, ego: usize) -> impl Iterator<Item = (usize, &Tie)> {
        self.ties.iter().filter_map(move |tie| match tie.pedestrians {
            [one, other] if one == ego => Some((other, tie)),
            [other, one] if one == ego => Some((other, tie)),
            _ => None,
        })
    }
}

/// The least distance (m) of two observed tracks.
pub(crate) fn least_distance(a: &[Position], b: &[Position]) -> f64 {
    a.iter().zip(b).map(|(p, q)| distance(*p, *q)).fold(f64::INFINITY, f64::min)
}

/// Groups of at least two pedestrians of a window who walk together, as indices in ascending order: linked by pairs
/// whose mean distance over the observation is below 2.2 m and whose mean velocities differ by less than 0.35 m/s.
///
/// Two who stand beside each other count as a group, too; nobody who is hardly observed does.
#[must_use]
pub fn groups(window: &Window) -> Vec<Vec<usize>> {
    Company::of(window).groups
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
