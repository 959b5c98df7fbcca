//! The pairs of pedestrians that may meet or walk together, with a table of factors for each.

use crate::energy::{Energy, PairEnergy, closeness};
use crate::groups::least_distance;
use crate::hypotheses::Hypotheses;
use ddl_core::{HORIZON, Position, SpatialIndex, distance};
use std::collections::BTreeSet;

/// Number of nearest pedestrians with which each forms pairs, so that pairs grow in proportion to people. One
/// pedestrian can be among the nearest of many.
const MOST_NEIGHBOURS: usize = 16;
/// A factor is at least this large relative to the largest of its row.
const LEAST_FACTOR: f32 = 3e-4;

/// Two pedestrians, `first` before `second` in the order of the scene.
#[derive(Debug)]
pub(crate) struct Pair {
    pub(crate) first: usize,
    pub(crate) second: usize,
    pub(crate) energy: PairEnergy,
    /// Factors `exp(-energy)`, `[first][second]`, and transposed.
    factors: [Vec<f32>; 2],
}

impl Pair {
    /// The factors of the hypotheses of one of the two, given the hypothesis of the other.
    pub(crate) fn factors(&self, of_first: bool, other: usize, count: usize) -> &[f32] {
        &self.factors[usize::from(of_first)][other * count..][..count]
    }
}

/// What is known of somebody who was observed.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ObservedWalk<'a> {
    /// 8 positions, metres.
    pub(crate) track: &'a [Position],
    /// The share of people around who let others come near.
    pub(crate) crowding: f64,
}

/// The pairs of a scene. `walks`: of each pedestrian; `None` for one who was not observed, and so walks with nobody.
pub(crate) fn pairs_of(energy: &Energy, people: &[Hypotheses], walks: &[Option<ObservedWalk<'_>>]) -> Vec<Pair> {
    let near = near_pairs(energy, people);
    let strength = |&(i, j): &(usize, usize)| match (walks[i], walks[j]) {
        (Some(a), Some(b)) => energy.strength(closeness(a.track, b.track)),
        _ => 0.0,
    };
    let strengths: Vec<f32> = near.iter().map(strength).collect();
    let mut partners = vec![0.0_f32; people.len()];
    for (&(i, j), _) in near.iter().zip(&strengths).filter(|(_, strength)| **strength > 0.0) {
        partners[i] += 1.0;
        partners[j] += 1.0;
    }
    let pairs = near.into_iter().zip(strengths);
    pairs
        .filter_map(|((i, j), strength)| {
            let apart = distance(people[i].present, people[j].present);
            let radius = people[i].radius + people[j].radius;
            let (kept, crowding) = match (walks[i], walks[j]) {
                (Some(a), Some(b)) => (least_distance(a.track, b.track), f64::midpoint(a.crowding, b.crowding)),
                (one, other) => (apart, one.or(other).map_or(0.0, |walk| walk.crowding)),
            };
            let kept = [kept.min(apart), radius];
            let pair = energy.of_pair(kept, crowding, strength, partners[i].max(partners[j]));
            let energies = table(&pair, &people[i], &people[j])?;
            Some(Pair {
                first: i,
                second: j,
                energy: pair,
                factors: factors(&energies, people[i].count(), people[j].count()),
            })
        })
        .collect()
}

/// For each pedestrian its pairs, each with the other pedestrian.
pub(crate) fn neighbours(people: usize, pairs: &[Pair]) -> Vec<Vec<(usize, usize)>> {
    let mut neighbours = vec![Vec::new(); people];
    for (index, pair) in pairs.iter().enumerate() {
        neighbours[pair.first].push((index, pair.second));
        neighbours[pair.second].push((index, pair.first));
    }
    neighbours
}

/// Pairs, in ascending order, that are close enough for a conflict or for walking together: of each pedestrian, those
/// with the nearest whom it may meet. So who is out of reach takes nobody's place.
fn near_pairs(energy: &Energy, people: &[Hypotheses]) -> BTreeSet<(usize, usize)> {
    let present: Vec<Position> = people.iter().map(|one| one.present).collect();
    let index = SpatialIndex::new(&present);
    let reach = |one: &Hypotheses| one.reach + one.radius;
    let within = |reach: f64| (reach + energy.reach()).max(energy.together_within());
    let farthest = people.iter().map(reach).fold(0.0, f64::max);
    let mut pairs = BTreeSet::new();
    for (i, one) in people.iter().enumerate() {
        let others = index.within_box(one.present, within(reach(one) + farthest)).filter(|&j| j != i);
        let apart = others.map(|j| (distance(one.present, people[j].present), j));
        let mut near: Vec<(f64, usize)> =
            apart.filter(|&(apart, j)| apart < within(reach(one) + reach(&people[j]))).collect();
        if near.len() > MOST_NEIGHBOURS {
            near.select_nth_unstable_by(MOST_NEIGHBOURS, |a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
            near.truncate(MOST_NEIGHBOURS);
        }
        pairs.extend(near.into_iter().map(|(_, j)| (i.min(j), i.max(j))));
    }
    pairs
}

/// The energies `[first][second]` of a pair; `None` if all are 0.
fn table(energy: &PairEnergy, first: &Hypotheses, second: &Hypotheses) -> Option<Vec<f32>> {
    let to_second = [0, 1].map(|axis| (second.present[axis] - first.present[axis]) as f32);
    let (rows, columns) = (first.count(), second.count());
    let mut energies = vec![0.0; rows * columns];
    let mut least = vec![f32::INFINITY; columns];
    let reach = energy.reach();
    let mut some = false;
    for a in 0..rows {
        least.fill(f32::INFINITY);
        for t in 1..=2 * HORIZON {
            let [ax, ay] = [0, 1].map(|axis| first.halfway(axis, t)[a] - to_second[axis]);
            let [bx, by] = [0, 1].map(|axis| second.halfway(axis, t));
            for ((least, x), y) in least.iter_mut().zip(bx).zip(by) {
                let squared = (x - ax) * (x - ax) + (y - ay) * (y - ay);
                *least = if squared < *least { squared } else { *least };
            }
        }
        let row = &mut energies[a * columns..][..columns];
        for (value, squared) in row.iter_mut().zip(&least) {
            if *squared < reach * reach {
                *value = energy.conflict(squared.sqrt());
            }
        }
        if energy.is_together() {
            let [ends_x, ends_y] = [0, 1].map(|axis| second.at(axis, HORIZON));
            let end = [0, 1].map(|axis| first.at(axis, HORIZON)[a]);
            for (b, value) in row.iter_mut().enumerate() {
                let [dx, dy] = [ends_x[b] - end[0], ends_y[b] - end[1]];
                *value += energy.apart(dx * dx + dy * dy);
            }
        }
        some |= row.iter().any(|value| *value > 0.0);
    }
    some.then_some(energies)
}

/// The factors of the second given the first and of the first given the second, each row with its largest as 1.
fn factors(energies: &[f32], rows: usize, columns: usize) -> [Vec<f32>; 2] {
    let of_second: Vec<f32> = energies.iter().map(|energy| (-energy).exp()).collect();
    let turned = |b: usize| (0..rows).map(move |a| a * columns + b);
    let of_first = (0..columns).flat_map(turned).map(|index| of_second[index]).collect();
    [(of_second, columns), (of_first, rows)].map(|(mut factors, length)| {
        for row in factors.chunks_exact_mut(length) {
            let largest = row.iter().copied().fold(f32::MIN_POSITIVE, f32::max);
            for factor in row {
                *factor = (*factor / largest).max(LEAST_FACTOR);
            }
        }
        factors
    })
}
