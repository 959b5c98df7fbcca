//! Values and gradients of eight pairs in `f64` and the exponential domain, for pairs beyond the range of `f32`.

#![expect(clippy::inline_always, reason = "the lanes must stay in registers")]

use ddl_simd::{Dispatch, Register, RegisterKernel, WIDE_LANES, wide_exp2_each};

use crate::range::{Range, WIDE_FLOOR};
use crate::refine::{GAMMAS, WIDE_GROUP, WideLanes, spread};
use crate::value::SoftDtw;

/// Largest difference of two components, in √γ, 2^20. The clamp on costs leaves up to 2^−57 of the alignment in a cell
/// that no path should pass. The gradient contains the product of this share and the difference.
const FARTHEST: f64 = 1_048_576.0;

/// Receives the index of a sequence, and the value and gradient of the pair.
pub(super) trait Visit<const D: usize>: FnMut(usize, f64, &[[f64; D]]) {}
impl<const D: usize, F: FnMut(usize, f64, &[[f64; D]])> Visit<D> for F {}

pub(super) struct WidePairs<const D: usize> {
    dtw: SoftDtw,
    dispatch: Dispatch,
    y: Vec<[WideLanes; D]>,
    gradient: Vec<[WideLanes; D]>,
    k: Vec<WideLanes>,
    alpha: Vec<WideLanes>,
    row: Vec<WideLanes>,
    single: Vec<[f64; D]>,
}

impl<const D: usize> WidePairs<D> {
    pub(super) fn new(dtw: SoftDtw, dispatch: Dispatch) -> Self {
        Self {
            dtw,
            dispatch,
            y: Vec::new(),
            gradient: Vec::new(),
            k: Vec::new(),
            alpha: Vec::new(),
            row: Vec::new(),
            single: Vec::new(),
        }
    }

    /// Evaluates `x` against up to eight of `sequences`, all of the same length. Indices of pairs out of range are
    /// added to `beyond`.
    pub(super) fn evaluate(
        &mut self,
        x: &[[f64; D]],
        members: &[usize],
        sequences: &[Vec<[f64; D]>],
        beyond: &mut Vec<usize>,
        visit: &mut impl Visit<D>,
    ) {
        let (n, m) = (x.len(), sequences[members[0]].len());
        let gamma = self.dtw.gamma();
        let fits = self.dtw.suits_lanes() && GAMMAS.contains(&gamma);
        let Some(range) = Range::wide(n, m).filter(|_| fits) else {
            beyond.extend(members);
            return;
        };
        self.y.resize(m, [[0.0; WIDE_LANES]; D]);
        for lane in 0..WIDE_LANES {
            let member = members[lane.min(members.len() - 1)];
            spread(&sequences[member], lane, &mut self.y);
        }
        self.gradient.resize(n, [[0.0; WIDE_LANES]; D]);
        self.k.resize(n * m, [0.0; WIDE_LANES]);
        self.alpha.resize(n * m, [0.0; WIDE_LANES]);
        self.row.resize(m, [0.0; WIDE_LANES]);
        self.single.resize(n, [0.0; D]);
        let start = f64::from(range.start_log2()).exp2();
        let scores = self.dispatch.run_on_registers(WideForwardBackward {
            x,
            start,
            seed: f64::from(range.seed_log2()).exp2(),
            scale: -std::f64::consts::LOG2_E / gamma,
            working: self,
        });
        let smallest = range.smallest_aligned_log2(n * m).exp2();
        for (lane, &member) in members.iter().enumerate() {
            let far = farthest(x, &sequences[member]) > FARTHEST * gamma.sqrt();
            if far || scores[lane] < smallest {
                beyond.push(member);
                continue;
            }
            for (single, lanes) in self.single.iter_mut().zip(&self.gradient) {
                for (single, lanes) in single.iter_mut().zip(lanes) {
                    *single = lanes[lane];
                }
            }
            // Dividing by a power of two is exact.
            let value = -gamma * (scores[lane] * (1.0 / start)).ln();
            visit(member, value, &self.single);
        }
    }
}

/// A bound on the differences of the components of any two steps.
fn farthest<const D: usize>(x: &[[f64; D]], y: &[[f64; D]]) -> f64 {
    let spread = |d: usize| {
        let components = || x.iter().chain(y).map(|step| step[d]);
        let least = components().fold(f64::INFINITY, f64::min);
        components().fold(f64::NEG_INFINITY, f64::max) - least
    };
    (0..D).map(spread).fold(0.0, f64::max)
}

/// The two recursions of [`super::forward_backward`] in `f64`.
struct WideForwardBackward<'a, const D: usize> {
    x: &'a [[f64; D]],
    start: f64,
    seed: f64,
    /// −log2 e / γ.
    scale: f64,
    working: &'a mut WidePairs<D>,
}

impl<const D: usize> RegisterKernel for WideForwardBackward<'_, D> {
    type Output = WideLanes;

    #[inline(always)]
    fn run<S: Register>(mut self, simd: S) -> WideLanes {
        let mut scores = [0.0; WIDE_LANES];
        for part in 0..S::PARTS {
            self.forward(simd, part, &mut scores);
        }
        let inverse = scores.map(|score| 1.0 / score);
        for part in 0..S::PARTS {
            self.backward(simd, part, &inverse);
        }
        scores
    }
}

impl<const D: usize> WideForwardBackward<'_, D> {
    #[inline(always)]
    fn forward<S: Register>(&mut self, simd: S, part: usize, scores: &mut WideLanes) {
        let (zero, scale) = (simd.wide_splat(0.0), simd.wide_splat(self.scale));
        let floor = simd.wide_splat(WIDE_FLOOR);
        let WidePairs { y, k, alpha, row, .. } = &mut *self.working;
        row.fill([0.0; WIDE_LANES]);
        let m = y.len();
        let mut corner = simd.wide_splat(self.start);
        let mut left = zero;
        let rows = k.chunks_exact_mut(m).zip(alpha.chunks_exact_mut(m));
        for (x, (k, alpha)) in self.x.iter().zip(rows) {
            for (k, y) in k.chunks_mut(WIDE_GROUP).zip(y.chunks(WIDE_GROUP)) {
                let mut exponents = [zero; WIDE_GROUP];
                for (exponent, y) in exponents.iter_mut().zip(y) {
                    let mut cost = zero;
                    for d in 0..D {
                        let y = simd.wide_load(&y[d], part);
                        let difference = simd.wide_sub(simd.wide_splat(x[d]), y);
                        cost = simd.wide_add(cost, simd.wide_mul(difference, difference));
                    }
                    *exponent = simd.wide_mul(cost, scale);
                }
                for (k, power) in k.iter_mut().zip(wide_exp2_each(simd, exponents)) {
                    simd.wide_store(power, k, part);
                }
            }
            let mut diagonal = corner;
            left = zero;
            for j in 0..m {
                let up = simd.wide_load(&row[j], part);
                let others = simd.wide_add(simd.wide_add(diagonal, up), floor);
                left = simd.wide_mul(simd.wide_load(&k[j], part), simd.wide_add(others, left));
                simd.wide_store(left, &mut alpha[j], part);
                simd.wide_store(left, &mut row[j], part);
                diagonal = up;
            }
            corner = zero;
        }
        simd.wide_store(left, scores, part);
    }

    #[inline(always)]
    fn backward<S: Register>(&mut self, simd: S, part: usize, inverse: &WideLanes) {
        let zero = simd.wide_splat(0.0);
        let floor = simd.wide_splat(WIDE_FLOOR);
        let inverse = simd.wide_load(inverse, part);
        // The slope of the squared cost is twice the difference.
        let unit = simd.wide_splat(2.0 / self.seed);
        let WidePairs {
            y,
            k,
            alpha,
            row,
            gradient,
            ..
        } = &mut *self.working;
        row.fill([0.0; WIDE_LANES]);
        let m = y.len();
        let mut end = simd.wide_splat(self.seed);
        let rows = k.chunks_exact(m).zip(alpha.chunks_exact(m));
        for ((x, gradient), (k, alpha)) in self.x.iter().zip(gradient).zip(rows).rev() {
            let mut sums = [zero; D];
            let mut right = end;
            let mut diagonal = zero;
            end = zero;
            for j in (0..m).rev() {
                let down = simd.wide_load(&row[j], part);
                let beta = simd.wide_add(simd.wide_add(diagonal, down), right);
                let share = simd.wide_mul(simd.wide_load(&alpha[j], part), inverse);
                let expected = simd.wide_mul(share, beta);
                for d in 0..D {
                    let difference = simd.wide_sub(simd.wide_splat(x[d]), simd.wide_load(&y[j][d], part));
                    sums[d] = simd.wide_add(sums[d], simd.wide_mul(expected, difference));
                }
                right = simd.wide_mul(simd.wide_load(&k[j], part), simd.wide_add(beta, floor));
                simd.wide_store(right, &mut row[j], part);
                diagonal = down;
            }
            for d in 0..D {
                simd.wide_store(simd.wide_mul(sums[d], unit), &mut gradient[d], part);
            }
        }
    }
}
