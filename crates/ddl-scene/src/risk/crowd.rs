//! Which deviations of a pedestrian come close to a plan.

use super::course::{CourseLeg, LegApproach, legs};
use super::quadrature::{DEVIATIONS, Quadrature};
use crate::{error::SceneError, futures::Futures, plan::Plan};
use ddl_core::{HORIZON, Position, between, bounds};
use std::array::from_fn;
use std::collections::BTreeMap;

/// What `f32` may be wrong by, as a share of the size of a coordinate.
const ROUNDING: f64 = 1e-6;
/// Deviations are looked at in blocks that fill vectors.
const BLOCK: usize = 8;
const BITS: [u32; BLOCK] = [1, 2, 4, 8, 16, 32, 64, 128];

/// The paths of a scene, arranged for the search.
#[derive(Debug)]
pub(super) struct CrowdAtRisk {
    n: usize,
    /// `[K][N]`, at the moment and 12 steps after it, metres.
    paths: Vec<[Position; HORIZON + 1]>,
    /// `[N]`, metres.
    scales: Vec<[f64; HORIZON + 1]>,
    /// `[K][N]`: around all deviations of a pedestrian from a hypothesis.
    rings: Vec<Rings>,
    /// `[N]`: around those from all hypotheses.
    outer_rings: Vec<Rings>,
    origin: Position,
    /// `[K]`: the deviations from each hypothesis.
    deviations: Vec<Deviations>,
    /// `[N]`: the part of the scene that each pedestrian belongs to.
    parts: Vec<usize>,
    /// `[N][K]`: probabilities of the hypotheses.
    pub(super) shares: Vec<Vec<f64>>,
}

#[derive(Debug)]
struct Deviations {
    exact: Quadrature,
    blocks: [CrowdBlock; DEVIATIONS / BLOCK],
}

impl Deviations {
    fn of_hypothesis(k: usize) -> Self {
        let exact = Quadrature::of_hypothesis(k);
        let block = |b: usize| {
            let [x, y] = [&exact.x, &exact.y].map(|all| from_fn(|j| all[b * BLOCK + j] as f32));
            let most = f32::hypot(x[BLOCK - 1], y[BLOCK - 1]) * (1.0 + ROUNDING as f32);
            CrowdBlock { x, y, most }
        };
        Self { blocks: from_fn(block), exact }
    }
}

/// Deviations one after the other, in scales.
#[derive(Debug)]
struct CrowdBlock {
    x: [f32; BLOCK],
    y: [f32; BLOCK],
    /// None of them is longer.
    most: f32,
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

/// Shares of deviations that come close: of those that are close at the moment itself, and of the others.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Hits {
    /// During each step.
    pub(super) steps: [[f64; 2]; HORIZON],
    /// By its end.
    pub(super) until: [[f64; 2]; HORIZON],
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
        let deviations: Vec<Deviations> = (0..count).map(Deviations::of_hypothesis).collect();
        let around = |i: usize, of: &[usize]| {
            let path = |k: usize| &paths[k * n + i];
            let farthest = of.iter().map(|&k| deviations[k].exact.farthest()).fold(0.0, f64::max);
            rings(origin, |step| {
                let margin = farthest * scales[i][step].max(scales[i][step + 1]);
                (of.iter().flat_map(move |&k| [path(k)[step], path(k)[step + 1]]), margin)
            })
        };
        let rings = pairs().map(|(i, k)| around(i, &[k])).collect();
        let all: Vec<usize> = (0..count).collect();
        let outer_rings = (0..n).map(|i| around(i, &all)).collect();
        let (mut parts, mut shares) = (vec![0; n], vec![Vec::new(); n]);
        for (p, part) in futures.parts().iter().enumerate() {
            for (row, &i) in part.pedestrians().iter().enumerate() {
                (parts[i], shares[i]) = (p, part.shares(row, count));
            }
        }
        Ok(Self { n, paths, scales, rings, outer_rings, origin, deviations, parts, shares })
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
        (0..self.n).filter(|i: &usize| near(&self.outer_rings[*i], &sweep.rings).is_some()).collect()
    }

    /// The deviations of pedestrian `i` that come close from its hypothesis `k`; `None` if none do.
    pub(super) fn hits(&self, sweep: &Sweep, i: usize, k: usize) -> Option<Hits> {
        let pair = k * self.n + i;
        let near = near(&self.rings[pair], &sweep.rings)?;
        let (mut now, mut first) = ([0; HORIZON], 0);
        for (l, leg) in sweep.legs.iter().enumerate().filter(|(_, leg)| near[leg.step] > 0) {
            let LegApproach { offsets, scales } = leg.approach(&self.paths[pair], &self.scales[i]);
            let reach = sweep.within + leg.radius;
            now[leg.step] |= self.close(k, offsets, scales, reach);
            if l == 0 && now[0] > 0 {
                first = self.close(k, [offsets[0]; 2], [scales[0]; 2], reach);
            }
        }
        let mut so_far = 0;
        let until = now.map(|now: u64| {
            so_far |= now;
            so_far
        });
        let share = |bits: u64| f64::from(bits.count_ones()) / DEVIATIONS as f64;
        let [steps, until] = [now, until].map(|steps| steps.map(|bits| [share(bits & first), share(bits & !first)]));
        (so_far > 0).then_some(Hits { steps, until })
    }

    /// The deviations from a hypothesis that come closer during a leg than this distance, one bit for each.
    fn close(&self, k: usize, offsets: [Position; 2], scales: [f64; 2], reach: f64) -> u64 {
        let offsets = offsets.map(|offset| offset.map(|number| number as f32));
        let way = PedestrianWay::new(offsets, scales, reach);
        let nearest = way.nearest() * (1.0 - 4.0 * ROUNDING as f32);
        let most = way.s + way.ds.max(0.0);
        let mut close = 0;
        // The outermost deviations first: further inside none come close if these stay away.
        for (b, block) in self.deviations[k].blocks.iter().enumerate().rev() {
            let reach = way.r + most * block.most;
            if nearest > reach * reach {
                break;
            }
            close |= u64::from(way.close(block)) << (b * BLOCK);
        }
        close
    }

    /// The least distance (m) of each deviation of pedestrian `i` on its hypothesis `k` from the edge of a plan.
    pub(super) fn distances(&self, legs: &[CourseLeg], i: usize, k: usize) -> [f64; DEVIATIONS] {
        let Quadrature { x, y } = &self.deviations[k].exact;
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

/// A leg in `f32`: from the plan to a pedestrian and its scale, where it begins and what is added until its end; the
/// distance that counts as close.
struct PedestrianWay {
    x: f32,
    y: f32,
    s: f32,
    r: f32,
    dx: f32,
    dy: f32,
    ds: f32,
}

impl PedestrianWay {
    fn new([[x, y], end]: [[f32; 2]; 2], scales: [f64; 2], reach: f64) -> Self {
        let [s, s1] = scales.map(|scale| scale as f32);
        Self { x, y, s, r: reach as f32, dx: end[0] - x, dy: end[1] - y, ds: s1 - s }
    }

    /// The least squared distance of the path itself.
    fn nearest(&self) -> f32 {
        let &Self { x, y, dx, dy, .. } = self;
        let share = -(x * dx + y * dy) / (dx * dx + dy * dy + f32::MIN_POSITIVE);
        let share = share.clamp(0.0, 1.0);
        let [x, y] = [x + share * dx, y + share * dy];
        x * x + y * y
    }

    /// The deviations of a block that come close, one bit for each.
    #[expect(clippy::needless_bitwise_bool, reason = "branches would keep the loop out of vectors")]
    fn close(&self, block: &CrowdBlock) -> u32 {
        let mut bits = [0; BLOCK];
        for j in 0..BLOCK {
            let [zx, zy] = [block.x[j], block.y[j]];
            let [x, y] = [self.x + self.s * zx, self.y + self.s * zy];
            let [dx, dy] = [self.dx + self.ds * zx, self.dy + self.ds * zy];
            // Close where a u^2 + 2 b u + c <= 0 for a share u of the leg.
            let a = dx * dx + dy * dy;
            let b = x * dx + y * dy;
            let c = x * x + y * y - self.r * self.r;
            let on_the_way = (b < 0.0) & (a + b > 0.0) & (a * c <= b * b);
            let is_close = (c <= 0.0) | (a + 2.0 * b + c <= 0.0) | on_the_way;
            bits[j] = if is_close { BITS[j] } else { 0 };
        }
        bits.iter().fold(0, |all, bit| all | bit)
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
