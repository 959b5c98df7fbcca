//! Which deviations of a pedestrian come close to a plan.

#![expect(clippy::inline_always, reason = "kernels are compiled for the instructions of the processor")]

use super::course::{CourseLeg, legs};
use super::quadrature::deviations_of_hypothesis;
use super::way::{DeviationBlock, PedestrianCourse};
use crate::{error::SceneError, futures::Futures, plan::Plan};
use ddl_core::{HORIZON, Position, between, bounds, distance};
use ddl_simd::{Dispatch, Kernel, LANES, Lanes, Simd};
use std::array::from_fn;

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
    places: Vec<[Lanes; 2]>,
    /// `[N]`, metres.
    present: Vec<Position>,
    /// `[N]`: around all deviations from all hypotheses.
    rings: Vec<Rings>,
    origin: Position,
    /// `[K]`: those from each hypothesis.
    deviations: Vec<Deviations>,
    /// `[K / 16]`: none of the deviations from a hypothesis is longer.
    outermost: Vec<Lanes>,
    /// `[N][K]`: probabilities of the hypotheses.
    pub(super) shares: Vec<Vec<f64>>,
}

/// Deviations from a hypothesis, in scales.
#[derive(Debug)]
struct Deviations {
    exact: Vec<Position>,
    blocks: Vec<DeviationBlock>,
}

impl Deviations {
    fn of_hypothesis(k: usize) -> Self {
        let exact = deviations_of_hypothesis(k);
        let blocks = exact.as_chunks().0.iter().map(DeviationBlock::of).collect();
        Self { exact, blocks }
    }

    /// None is longer.
    fn outermost(&self) -> f32 {
        self.blocks.last().map_or(0.0, |block| block.most)
    }
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

/// How likely a pedestrian comes close to a plan: during each step, then until its end.
pub(super) type Hits = [Closeness; 2 * HORIZON];

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
        let mut shares = vec![Vec::new(); n];
        for part in futures.parts() {
            for (row, &i) in part.pedestrians().iter().enumerate() {
                shares[i] = part.shares(row, count);
            }
        }
        let deviations: Vec<Deviations> = (0..count).map(Deviations::of_hypothesis).collect();
        let outermost = lanes(count, |k| deviations[k].outermost()).collect();
        let of_step = |i: usize, step: usize| {
            let (paths, scales, deviations) = (&paths, &scales, &deviations);
            (0..count).map(move |k| (paths[k * n + i][step], f64::from(deviations[k].outermost()) * scales[i][step]))
        };
        let around = |i: usize| rings(origin, |step| of_step(i, step).chain(of_step(i, step + 1)));
        let rings = (0..n).map(around).collect();
        let present: Vec<Position> = (0..n).map(|i| futures.present(i)).collect();
        let places = |(i, step): (usize, usize)| {
            let at = |axis: usize| {
                let (paths, present) = (&paths, present[i]);
                lanes(count, move |k| (paths[k * n + i][step][axis] - present[axis]) as f32)
            };
            at(0).zip(at(1)).map(|(x, y)| [x, y])
        };
        let places = (0..n).flat_map(|i| (0..=HORIZON).map(move |step| (i, step))).flat_map(places).collect();
        Ok(Self { n, paths, scales, places, present, rings, origin, deviations, outermost, shares })
    }

    /// The room within `within` metres of the edge of a plan.
    pub(super) fn sweep(&self, plan: &Plan, within: f64) -> Sweep {
        let legs = legs(plan);
        let rings = rings(self.origin, |step| {
            let of_step = legs.iter().filter(move |leg| leg.step == step);
            of_step.flat_map(|leg| leg.positions.map(|at| (at, within + leg.radius)))
        });
        Sweep { legs, within, rings }
    }

    /// The pedestrians that come close on some hypothesis, and perhaps others.
    pub(super) fn near(&self, sweep: &Sweep) -> impl Iterator<Item = usize> {
        (0..self.n).filter(|i: &usize| near(&self.rings[*i], &sweep.rings).is_some())
    }

    /// How likely pedestrian `i`, whose hypotheses have these probabilities, comes close; `None` if surely not.
    pub(super) fn hits(&self, sweep: &Sweep, i: usize, shares: &[f64]) -> Option<Hits> {
        let mut search = CrowdSearch { crowd: self, sweep, pedestrian: i, shares, hits: None };
        Dispatch::detect().run(&mut search);
        search.hits
    }

    /// The least distance (m) of each deviation of pedestrian `i` on its hypothesis `k` from the edge of a plan.
    pub(super) fn distances(&self, legs: &[CourseLeg], i: usize, k: usize) -> Vec<f64> {
        let deviations = &self.deviations[k].exact;
        let mut least = vec![f64::INFINITY; deviations.len()];
        for leg in legs {
            let approach = leg.approach(&self.paths[k * self.n + i], &self.scales[i]);
            for (least, z) in least.iter_mut().zip(deviations) {
                *least = least.min(leg.distance(&approach, *z));
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
    hits: Option<Hits>,
}

/// The deviations of a hypothesis that come close, one bit for each.
#[derive(Debug, Clone, Copy, Default)]
struct Close {
    at_moment: u64,
    before: u64,
    during: u64,
}

impl Kernel for &mut CrowdSearch<'_> {
    #[inline(always)]
    fn run<S: Simd>(self, simd: S) {
        let (Sweep { legs, within, rings }, crowd, i) = (self.sweep, self.crowd, self.pedestrian);
        let Some(near) = near(&crowd.rings[i], rings) else { return };
        let count = self.shares.len();
        let chunks = count.div_ceil(LANES);
        let mut close = vec![Close::default(); count];
        // During each step, and for the first time.
        let [mut steps, mut first] = [[[0.0; 2]; HORIZON]; 2];
        for (l, leg) in legs.iter().enumerate().filter(|(_, leg)| near[leg.step] > 0) {
            let course = PedestrianCourse::new(leg, crowd.present[i], &crowd.scales[i], within + leg.radius);
            let begins = l == 0 || legs[l - 1].step < leg.step;
            if begins {
                for close in &mut close {
                    close.during = 0;
                }
            }
            for chunk in 0..chunks {
                // The last lanes may be without a hypothesis.
                let hypotheses = (1 << LANES.min(count - chunk * LANES)) - 1;
                let at = |step: usize| &crowd.places[(i * (HORIZON + 1) + step) * chunks + chunk];
                let ways = course.ways(simd, at(leg.step), at(leg.step + 1));
                let mut lanes = ways.within(simd, &crowd.outermost[chunk]) & hypotheses;
                while lanes > 0 {
                    let lane = lanes.trailing_zeros() as usize;
                    lanes &= lanes - 1;
                    let k = chunk * LANES + lane;
                    let (way, of_k) = (ways.way(lane), &crowd.deviations[k].blocks);
                    let now = way.close(simd, of_k, ways.nearest(lane));
                    if now == 0 {
                        continue;
                    }
                    let close = &mut close[k];
                    if l == 0 {
                        close.at_moment = way.at_start().close(simd, of_k, 0.0);
                    }
                    let each = self.shares[k] / (of_k.len() * LANES) as f64;
                    for (sums, new) in [(&mut steps, now & !close.during), (&mut first, now & !close.before)] {
                        let share = |bits: u64| each * f64::from(bits.count_ones());
                        let [moment, later] = &mut sums[leg.step];
                        *later += share(new & !close.at_moment);
                        if close.at_moment > 0 {
                            *moment += share(new & close.at_moment);
                        }
                    }
                    close.during |= now;
                    close.before |= now;
                }
            }
        }
        let mut until = [0.0; 2];
        let so_far = first.map(|new| {
            until = [until[0] + new[0], until[1] + new[1]];
            until
        });
        let hits: Hits = from_fn(|row| [steps, so_far].as_flattened()[row]);
        self.hits = (until[0] + until[1] > 0.0).then_some(hits);
    }
}

/// Values of hypotheses, sixteen at a time; 0 behind the last one.
fn lanes(count: usize, value: impl Fn(usize) -> f32) -> impl Iterator<Item = Lanes> {
    let at = move |k: usize| if k < count { value(k) } else { 0.0 };
    (0..count).step_by(LANES).map(move |first| Lanes(from_fn(|lane| at(first + lane))))
}

/// Discs around discs of each step, with what rounding may hide.
fn rings<D: Iterator<Item = (Position, f64)> + Clone>(origin: Position, of_step: impl Fn(usize) -> D) -> Rings {
    let discs: [[f64; 3]; HORIZON] = from_fn(|step| {
        let discs = of_step(step);
        let [low, high] = bounds(discs.clone().map(|(at, _)| at)).unwrap_or([origin; 2]);
        let middle = between(low, high, 0.5);
        let radius = discs.map(|(at, radius)| distance(at, middle) + radius).fold(0.0, f64::max);
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
