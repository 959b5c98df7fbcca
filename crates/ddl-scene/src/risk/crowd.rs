//! Which deviations of a pedestrian come close to a plan.

#![expect(clippy::inline_always, reason = "kernels are compiled for the instructions of the processor")]

use super::course::{CourseLeg, legs};
use super::quadrature::{DEVIATIONS, DeviationBlocks, Quadrature};
use super::way::PedestrianCourse;
use crate::{error::SceneError, futures::Futures, plan::Plan};
use ddl_core::{HORIZON, Position, between, bounds};
use ddl_simd::{Dispatch, Kernel, LANES, Lanes, Simd};
use std::array::from_fn;
use std::collections::BTreeMap;

/// What `f32` may be wrong by, as a share of the size of a coordinate.
const ROUNDING: f64 = 1e-6;

/// The paths of a scene, arranged for the search.
#[derive(Debug)]
pub(super) struct CrowdAtRisk {
    n: usize,
    /// `[K][N]`, at the moment and 12 steps after it, metres.
    paths: Vec<[Position; HORIZON + 1]>,
    /// `[N]`, metres.
    scales: Vec<[f64; HORIZON + 1]>,
    /// `[N][13][K / 16]`: x and y of the same paths, metres from the present position of the pedestrian.
    lanes: Vec<[Lanes; 2]>,
    /// `[N]`, metres.
    present: Vec<Position>,
    /// `[N]`: around all deviations from all hypotheses.
    rings: Vec<Rings>,
    origin: Position,
    /// `[K]`: the deviations from each hypothesis, exactly and in blocks.
    deviations: Vec<(Quadrature, DeviationBlocks)>,
    /// None of the deviations is longer, in scales.
    outermost: f32,
    /// `[N]`: the part of the scene that each pedestrian belongs to.
    parts: Vec<usize>,
    /// `[N][K]`: probabilities of the hypotheses.
    pub(super) shares: Vec<Vec<f64>>,
}

/// Discs in which somebody stays during each step: x and y (m from the origin of the crowd), radius (m).
type Rings = [[f32; HORIZON]; 3];

/// A plan with the room around it.
#[derive(Debug)]
pub(super) struct Sweep {
    legs: Vec<CourseLeg>,
    within: f64,
    rings: Rings,
}

/// Probabilities that a pedestrian comes close: where it is close at the moment itself, and otherwise.
pub(super) type Closeness = [f64; 2];

/// How likely a pedestrian comes close to a plan.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Hits {
    /// During each step, then until its end.
    pub(super) steps: [Closeness; 2 * HORIZON],
    /// The same on each hypothesis on which it comes close.
    pub(super) of_hypotheses: Vec<(usize, [Closeness; 2 * HORIZON])>,
}

impl CrowdAtRisk {
    pub(super) fn new(futures: &Futures) -> Result<Self, SceneError> {
        let (n, forecast) = (futures.pedestrians(), futures.hypotheses());
        let count = forecast.hypotheses();
        let scales = (0..n).map(|i| {
            let mut scales = [0.0; HORIZON + 1];
            for (step, scale) in scales.iter_mut().enumerate() {
                *scale = futures.scale_at(i, step).ok_or(SceneError::NoSpread)?;
            }
            Ok(scales)
        });
        let scales: Vec<_> = scales.collect::<Result<_, SceneError>>()?;
        let pairs = || (0..count).flat_map(|k| (0..n).map(move |i| (i, k)));
        let path = |(i, k)| {
            let mut path = [futures.start(i, k); HORIZON + 1];
            path[1..].copy_from_slice(forecast.hypothesis(i, k));
            path
        };
        let paths: Vec<_> = pairs().map(path).collect();
        let origin = futures.present(0);
        let of_hypothesis = |k| {
            let exact = Quadrature::of_hypothesis(k);
            let blocks = DeviationBlocks::of(&exact);
            (exact, blocks)
        };
        let deviations: Vec<_> = (0..count).map(of_hypothesis).collect();
        let farthest = deviations.iter().map(|(exact, _)| exact.farthest()).fold(0.0, f64::max);
        let of_step = |i: usize, step: usize| (0..count).map(move |k| (k * n + i, step));
        let around = |i: usize| {
            rings(origin, |step| {
                let both = of_step(i, step).chain(of_step(i, step + 1));
                let margin = farthest * scales[i][step].max(scales[i][step + 1]);
                (both.map(|(pair, step)| paths[pair][step]), margin)
            })
        };
        let rings = (0..n).map(around).collect();
        let present: Vec<Position> = (0..n).map(|i| futures.present(i)).collect();
        let lanes_of = |(i, step, first): (usize, usize, usize)| {
            let at = |axis: usize, k: usize| {
                paths.get(k * n + i).map_or(0.0, |path| (path[step][axis] - present[i][axis]) as f32)
            };
            [0, 1].map(|axis| Lanes(from_fn(|lane| at(axis, first + lane))))
        };
        let firsts = |(i, step)| (0..count).step_by(LANES).map(move |first| (i, step, first));
        let lanes =
            (0..n).flat_map(|i| (0..=HORIZON).map(move |step| (i, step))).flat_map(firsts).map(lanes_of).collect();
        let (mut parts, mut shares) = (vec![0; n], vec![Vec::new(); n]);
        for (p, part) in futures.parts().iter().enumerate() {
            for (row, &i) in part.pedestrians().iter().enumerate() {
                (parts[i], shares[i]) = (p, part.shares(row, count));
            }
        }
        let outermost = deviations.iter().map(|(_, blocks)| blocks.outermost()).fold(0.0, f32::max);
        Ok(Self { n, paths, scales, lanes, present, rings, origin, deviations, outermost, parts, shares })
    }

    /// These pedestrians, in ascending order, by the part that they belong to.
    pub(super) fn by_part(&self, pedestrians: impl Iterator<Item = usize>) -> BTreeMap<usize, Vec<usize>> {
        let mut by_part: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
        for i in pedestrians {
            by_part.entry(self.parts[i]).or_default().push(i);
        }
        by_part
    }

    /// The room within `within` metres of the edge of a plan.
    pub(super) fn sweep(&self, plan: &Plan, within: f64) -> Sweep {
        let legs = legs(plan);
        let rings = rings(self.origin, |step| {
            let of_step = || legs.iter().filter(move |leg| leg.step == step);
            let radius = of_step().map(|leg| leg.radius).fold(0.0, f64::max);
            (of_step().flat_map(|leg| leg.positions), within + radius)
        });
        Sweep { legs, within, rings }
    }

    /// The pedestrians that come close on some hypothesis, and perhaps others.
    pub(super) fn near(&self, sweep: &Sweep) -> Vec<usize> {
        (0..self.n).filter(|i: &usize| near(&self.rings[*i], &sweep.rings).is_some()).collect()
    }

    /// How likely pedestrian `i`, whose hypotheses have these probabilities, comes close; `None` if surely not.
    pub(super) fn hits(&self, sweep: &Sweep, i: usize, shares: &[f64]) -> Option<Hits> {
        let hits = Hits { steps: [[0.0; 2]; 2 * HORIZON], of_hypotheses: Vec::new() };
        let mut search = CrowdSearch { crowd: self, sweep, pedestrian: i, shares, hits };
        Dispatch::detect().run(&mut search);
        (!search.hits.of_hypotheses.is_empty()).then_some(search.hits)
    }

    /// The least distance (m) of each deviation of pedestrian `i` on its hypothesis `k` from the edge of a plan.
    pub(super) fn distances(&self, legs: &[CourseLeg], i: usize, k: usize) -> [f64; DEVIATIONS] {
        let Quadrature { x, y } = &self.deviations[k].0;
        let mut least = [f64::INFINITY; DEVIATIONS];
        for leg in legs {
            let approach = leg.approach(&self.paths[k * self.n + i], &self.scales[i]);
            for (least, z) in least.iter_mut().zip(from_fn::<_, DEVIATIONS, _>(|j| [x[j], y[j]])) {
                *least = least.min(leg.distance(&approach, z));
            }
        }
        least
    }
}

/// The search for the deviations of one pedestrian that come close.
struct CrowdSearch<'a> {
    crowd: &'a CrowdAtRisk,
    sweep: &'a Sweep,
    pedestrian: usize,
    shares: &'a [f64],
    hits: Hits,
}

impl Kernel for &mut CrowdSearch<'_> {
    #[inline(always)]
    fn run<S: Simd>(self, simd: S) {
        let (Sweep { legs, within, rings }, crowd, i) = (self.sweep, self.crowd, self.pedestrian);
        let Some(near) = near(&crowd.rings[i], rings) else { return };
        let count = self.shares.len();
        let chunks = count.div_ceil(LANES);
        // Of each hypothesis the deviations that come close during each step, then those that are at the moment itself.
        let mut close = vec![[0_u64; HORIZON + 1]; count];
        for (l, leg) in legs.iter().enumerate().filter(|(_, leg)| near[leg.step] > 0) {
            let course = PedestrianCourse::new(leg, crowd.present[i], &crowd.scales[i], within + leg.radius);
            for chunk in 0..chunks {
                // The last lanes may be without a hypothesis.
                let hypotheses = (1 << LANES.min(count - chunk * LANES)) - 1;
                let at = |step: usize| &crowd.lanes[(i * (HORIZON + 1) + step) * chunks + chunk];
                let ways = course.ways(simd, at(leg.step), at(leg.step + 1));
                let mut lanes = ways.within(simd, crowd.outermost) & hypotheses;
                while lanes > 0 {
                    let lane = lanes.trailing_zeros() as usize;
                    lanes &= lanes - 1;
                    let k = chunk * LANES + lane;
                    let (way, blocks) = (ways.way(lane), &crowd.deviations[k].1);
                    let bits = way.close(simd, blocks, ways.nearest(lane));
                    close[k][leg.step] |= bits;
                    if l == 0 && bits > 0 {
                        close[k][HORIZON] = way.at_start().close(simd, blocks, 0.0);
                    }
                }
            }
        }
        for (k, (close, share)) in close.iter().zip(self.shares).enumerate() {
            let [during @ .., first] = close;
            if *share > 0.0 && during.iter().any(|bits| *bits > 0) {
                self.hits.add(k, *share, *during, *first);
            }
        }
    }
}

impl Hits {
    /// Adds the deviations from hypothesis `k`, which has this probability, that come close during each step, and those
    /// that are close at the moment itself.
    #[inline(always)]
    fn add(&mut self, k: usize, share: f64, during: [u64; HORIZON], first: u64) {
        let count = |bits: u64| f64::from(bits.count_ones()) / DEVIATIONS as f64;
        let (mut until, mut steps) = (0, [[0.0; 2]; 2 * HORIZON]);
        for (step, now) in during.into_iter().enumerate() {
            until |= now;
            for (index, bits) in [(step, now), (HORIZON + step, until)] {
                steps[index] = [if first > 0 { count(bits & first) } else { 0.0 }, count(bits & !first)];
            }
        }
        for (sum, of_hypothesis) in self.steps.as_flattened_mut().iter_mut().zip(steps.as_flattened()) {
            *sum += share * of_hypothesis;
        }
        self.of_hypotheses.push((k, steps));
    }
}

/// Discs around the positions of each step, larger by a margin (m), and by what rounding may hide.
fn rings<P: Iterator<Item = Position> + Clone>(origin: Position, of_step: impl Fn(usize) -> (P, f64)) -> Rings {
    let discs: [[f64; 3]; HORIZON] = from_fn(|step| {
        let (positions, margin) = of_step(step);
        let [low, high] = bounds(positions.clone()).unwrap_or([origin; 2]);
        let middle = between(low, high, 0.5);
        let square = |at: Position| (at[0] - middle[0]).powi(2) + (at[1] - middle[1]).powi(2);
        let radius = positions.map(square).fold(0.0, f64::max).sqrt() + margin;
        let [x, y] = [0, 1].map(|axis| middle[axis] - origin[axis]);
        [x, y, radius + ROUNDING * (x.abs() + y.abs() + radius)]
    });
    from_fn(|row| from_fn(|step| discs[step][row] as f32))
}

/// The steps during which two may touch, marked 1; `None` if there are none.
#[inline(always)]
fn near(a: &Rings, b: &Rings) -> Option<[u32; HORIZON]> {
    let mut near = [0; HORIZON];
    let mut any = 0;
    for step in 0..HORIZON {
        let [x, y, reach] = [a[0][step] - b[0][step], a[1][step] - b[1][step], a[2][step] + b[2][step]];
        near[step] = u32::from(x * x + y * y <= reach * reach);
        any |= near[step];
    }
    (any == 1).then_some(near)
}
