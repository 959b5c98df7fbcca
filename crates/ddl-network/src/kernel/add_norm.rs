//! Dropout, residual connection and layer normalisation (Ba et al. 2016) after a sublayer.

mod rows;
#[cfg(test)]
mod tests;

use crate::kernel::columns::{load, store};
use ddl_simd::{DEPTH, LANES, Lanes, Simd};
use fearless_simd::prelude::*;
pub(super) use rows::Decisions;
use rows::{Four, means};

/// Added to the variance before the square root.
const EPSILON: f32 = 1e-5;

/// y = (s − mean s) / √(var s + 1e-5) · weight + bias of s = x + d(t) for each row, with dropout d.
#[derive(Clone, Debug)]
pub(super) struct AddNorm {
    width: usize,
    weight: Vec<Lanes>,
    bias: Vec<Lanes>,
    /// 1 for columns within the width, 0 for padding.
    inside: Vec<Lanes>,
}

/// Results of the forward pass that the backward pass needs; empty if there will be none.
pub(super) struct Normal<'a> {
    /// (s − mean) / deviation, `[rows, width]`.
    pub(super) numbers: &'a mut [f32],
    /// 1 / deviation, `[rows]`.
    pub(super) scales: &'a mut [f32],
}

impl AddNorm {
    pub(super) fn new(width: usize) -> Self {
        let vectors = width.div_ceil(LANES);
        let mut inside = vec![Lanes::ZERO; vectors];
        for column in 0..width {
            inside[column / LANES].0[column % LANES] = 1.0;
        }
        Self { width, weight: vec![Lanes::ZERO; vectors], bias: vec![Lanes::ZERO; vectors], inside }
    }

    pub(super) fn update(&mut self, weight: &[f32], bias: &[f32]) {
        assert_eq!(weight.len(), self.width, "entries of the weight");
        assert_eq!(bias.len(), self.width, "entries of the bias");
        for (lanes, values) in [(&mut self.weight, weight), (&mut self.bias, bias)] {
            for (lanes, values) in lanes.iter_mut().zip(values.chunks(LANES)) {
                lanes.0[..values.len()].copy_from_slice(values);
            }
        }
    }

    /// `x`, `t` `[rows, width]` -> `normal` and `y` `[rows, width]`, overwritten. `decisions` come with the index of
    /// the first row.
    #[inline(always)]
    pub(super) fn forward<S: Simd>(
        &self,
        simd: S,
        [x, t]: [&[f32]; 2],
        decisions: Option<(Decisions, usize)>,
        normal: &mut Normal<'_>,
        y: &mut [f32],
    ) {
        let width = self.width;
        let rows = x.len() / width;
        assert!([0, rows].contains(&normal.scales.len()), "scales of the rows");
        let mut four = Four::new(self.inside.len());
        let whole = rows / DEPTH * DEPTH;
        for first in (0..whole).step_by(DEPTH) {
            self.forward_four(simd, [x, t], decisions, normal, y, (first, DEPTH), &mut four);
        }
        if whole < rows {
            self.forward_four(simd, [x, t], decisions, normal, y, (whole, rows - whole), &mut four);
        }
    }

    /// Up to four rows from `first` on. It is inlined; for whole groups `count` is a constant, so that their rows stay
    /// in registers.
    #[inline(always)]
    #[expect(clippy::too_many_arguments, reason = "those of the rows, and which of them")]
    fn forward_four<S: Simd>(
        &self,
        simd: S,
        [x, t]: [&[f32]; 2],
        decisions: Option<(Decisions, usize)>,
        normal: &mut Normal<'_>,
        y: &mut [f32],
        (first, count): (usize, usize),
        four: &mut Four,
    ) {
        let (width, vectors) = (self.width, four.vectors());
        // For whole groups these slices have a constant length, and their rows need no check of bounds.
        let here = first * width..first * width + count * width;
        let (x, t, y) = (&x[here.clone()], &t[here.clone()], &mut y[here.clone()]);
        for r in 0..count {
            let row = r * width..(r + 1) * width;
            let (x, t) = (&x[row.clone()], &t[row]);
            for v in 0..vectors {
                let column = v * LANES;
                let term = load(simd, t, column);
                let term = match decisions {
                    Some((decisions, start)) => decisions.apply(simd, term, start + first + r, column),
                    None => term,
                };
                four.set(simd, r, v, load(simd, x, column) + term);
            }
        }
        let scales = self.centre(simd, four);
        for r in 0..count {
            let scale = simd.splat(scales[r]);
            let y = &mut y[r * width..(r + 1) * width];
            for v in 0..vectors {
                let number = four.get(simd, r, v) * scale;
                four.set(simd, r, v, number);
                let weight = simd.load(&self.weight[v].0);
                store(simd, number.mul_add(weight, simd.load(&self.bias[v].0)), y, v * LANES);
            }
        }
        if !normal.scales.is_empty() {
            normal.scales[first..first + count].copy_from_slice(&scales[..count]);
            let numbers = &mut normal.numbers[here];
            for r in 0..count {
                let numbers = &mut numbers[r * width..(r + 1) * width];
                for v in 0..vectors {
                    store(simd, four.get(simd, r, v), numbers, v * LANES);
                }
            }
        }
    }

    /// Subtracts the mean of each row. Returns 1 over the deviations.
    #[inline(always)]
    fn centre<S: Simd>(&self, simd: S, four: &mut Four) -> [f32; DEPTH] {
        let (width, vectors) = (self.width, four.vectors());
        let mean = simd.spread_each(means(simd, width, four.sums(simd)));
        for r in 0..DEPTH {
            for v in 0..vectors {
                let centred = four.get(simd, r, v) - mean[r];
                four.set(simd, r, v, centred * simd.load(&self.inside[v].0));
            }
        }
        // The variances of the four rows are in the first four lanes; roots of all lanes would take several times as
        // long.
        let mut variances = Lanes::ZERO;
        simd.store(means(simd, width, four.products(simd, four)), &mut variances.0);
        let mut scales = [0.0; DEPTH];
        for (scale, variance) in scales.iter_mut().zip(variances.0) {
            *scale = 1.0 / (variance + EPSILON).sqrt();
        }
        scales
    }

    /// Gradients: `normal` of the forward pass and `gy` `[rows, width]` -> those of x and t, `[rows, width]`,
    /// overwritten. The gradients of weight and bias are added to `of_weights`.
    #[inline(always)]
    pub(super) fn backward<S: Simd>(
        &self,
        simd: S,
        [numbers, scales]: [&[f32]; 2],
        gy: &[f32],
        decisions: Option<(Decisions, usize)>,
        [gx, gt]: [&mut [f32]; 2],
        [of_weight, of_bias]: [&mut [f32]; 2],
    ) {
        let width = self.width;
        let new = || Four::new(self.inside.len());
        let (mut normal, mut gradient, mut sums) = (new(), new(), [new(), new()]);
        let vectors = normal.vectors();
        let rows = numbers.len() / width;
        for first in (0..rows).step_by(DEPTH) {
            let count = DEPTH.min(rows - first);
            for r in 0..count {
                let row = (first + r) * width..(first + r + 1) * width;
                let (numbers, gy) = (&numbers[row.clone()], &gy[row]);
                for v in 0..vectors {
                    let number = load(simd, numbers, v * LANES);
                    let of_y = load(simd, gy, v * LANES);
                    normal.set(simd, r, v, number);
                    gradient.set(simd, r, v, of_y * simd.load(&self.weight[v].0));
                    let [weight, bias] = &mut sums;
                    weight.set(simd, 0, v, of_y.mul_add(number, weight.get(simd, 0, v)));
                    bias.set(simd, 0, v, of_y + bias.get(simd, 0, v));
                }
            }
            let mean = simd.spread_each(means(simd, width, gradient.sums(simd)));
            let product = means(simd, width, gradient.products(simd, &normal));
            let product = simd.spread_each(product);
            for r in 0..count {
                let scale = simd.splat(scales[first + r]);
                let row = (first + r) * width..(first + r + 1) * width;
                let (gx, gt) = (&mut gx[row.clone()], &mut gt[row]);
                for v in 0..vectors {
                    let column = v * LANES;
                    let centred = gradient.get(simd, r, v) - mean[r];
                    let along = normal.get(simd, r, v) * product[r];
                    let of_sum = (centred - along) * scale;
                    store(simd, of_sum, gx, column);
                    let of_term = match decisions {
                        Some((decisions, start)) => decisions.apply(simd, of_sum, start + first + r, column),
                        None => of_sum,
                    };
                    store(simd, of_term, gt, column);
                }
            }
        }
        for v in 0..vectors {
            for (sum, into) in sums.iter().zip([&mut *of_weight, &mut *of_bias]) {
                store(simd, load(simd, into, v * LANES) + sum.get(simd, 0, v), into, v * LANES);
            }
        }
    }
}
