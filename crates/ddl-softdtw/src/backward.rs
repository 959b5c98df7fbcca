//! The backward recursion: the expected alignment of two sequences, and the gradient from it.
#![expect(clippy::inline_always, reason = "the lanes must stay in registers")]

use crate::forward::{ForwardStep, STRETCH};
use crate::grid::{Grid, STRIP, Slanted, Strip};
use crate::weight::{NONE, Weight, above, lane, normalised, normalised_one, shares, splat, sums};
use ddl_simd::{Dispatch, Kernel, Simd};
use fearless_simd::f64x8;
use fearless_simd::prelude::*;

impl<const D: usize> Grid<'_, D> {
    /// The value and its gradient with respect to the rows; not finite when they exceed the range of `f64`.
    ///
    /// With S(i, j), the sum of exp(−cost/γ) over the paths from cell (i, j) to the last one, without its own cost,
    ///
    /// ```text
    /// S(i, j) = 2^−t(i+1, j+1) S(i+1, j+1) + 2^−t(i+1, j) S(i+1, j) + 2^−t(i, j+1) S(i, j+1)
    /// ```
    ///
    /// the expected alignment is E(i, j) = R(i, j) S(i, j) / R(n, m). S is computed strip by strip backwards.
    pub(crate) fn value_and_gradient(&self) -> (f64, Vec<[f64; D]>) {
        self.value_and_gradient_with(Dispatch::detect())
    }

    /// The same bits for every instruction set, as the value.
    pub(crate) fn value_and_gradient_with(&self, dispatch: Dispatch) -> (f64, Vec<[f64; D]>) {
        if !self.is_exact() {
            return self.log_domain_gradient();
        }
        let mut result = (0.0, Vec::new());
        dispatch.run(BackwardPass(self, &mut result));
        result
    }

    #[inline(always)]
    fn backward<S: Simd>(&self, simd: S) -> (f64, Vec<[f64; D]>) {
        let mut steps = Vec::with_capacity(self.strips() * (self.columns.len() + STRIP));
        let columns = Slanted::of(self.columns);
        let total = self.forward::<S, true>(simd, &columns, &mut steps);
        // S starts from a power of two. Its product with R(n, m) has the exponent 0.
        let [significand, exponent] = total;
        let mut below = vec![NONE; self.columns.len() + 2 * (STRIP - 1)];
        // Every path ends in the last cell, as if it continued along the diagonal.
        below[self.columns.len() + STRIP - 1] = [1.0, -exponent];
        let mut gradient = vec![[0.0; D]; self.rows.len()];
        let mut steps = steps.as_slice();
        for index in (0..self.strips()).rev() {
            let strip = self.strip(index);
            let (earlier, strip_steps) = steps.split_at(steps.len() - (strip.end + 1 - strip.start));
            steps = earlier;
            let of_lanes = Self::retreat(simd, &strip, strip_steps, &columns, significand, &mut below);
            for lane in 0..STRIP {
                // Lanes above the first row do not belong to a row.
                if let Some(row) = (index * STRIP + lane).checked_sub(self.spare_lanes()) {
                    for (component, of_lanes) in gradient[row].iter_mut().zip(&of_lanes) {
                        *component = of_lanes[lane];
                    }
                }
            }
            if index % (STRETCH / STRIP) == 0 {
                for cell in &mut below {
                    *cell = normalised_one(*cell);
                }
            }
        }
        (self.value_of(total), gradient)
    }

    /// One strip backwards: the gradient of each of its rows, component by component. `below` holds 2^−t S of the row
    /// below the strip, entry c + 7 for column c, and then that of its first row.
    #[inline(always)]
    fn retreat<S: Simd>(
        simd: S,
        strip: &Strip<D>,
        steps: &[ForwardStep<S>],
        columns: &Slanted<D>,
        significand: f64,
        below: &mut [Weight],
    ) -> [f64x8<S>; D] {
        let row = &mut below[..strip.end + STRIP];
        let mut gradient = [f64x8::splat(simd, 0.0); D];
        let mut cells = splat(simd, NONE);
        let mut diagonal = above(simd, cells, row[strip.end + 1]);
        for (offset, step) in steps.iter().enumerate().rev() {
            let d = strip.start + offset;
            let down = above(simd, cells, row[d]);
            let sum;
            [sum, cells] = sums([diagonal, down, cells], step.factor);
            diagonal = down;
            row[d + STRIP - 1] = lane(cells, 0);
            // Beyond the first and the last column the expected alignment is 0.
            let expected = shares(simd, step.cells, sum, significand);
            let differences = columns.differences(simd, &strip.x, d);
            let slope = expected * 2.0;
            for k in 0..D {
                gradient[k] += slope * differences[k];
            }
            if d.is_multiple_of(STRETCH) {
                cells = normalised(cells);
            }
        }
        gradient
    }
}

struct BackwardPass<'a, 'b, const D: usize>(&'a Grid<'b, D>, &'a mut (f64, Vec<[f64; D]>));

impl<const D: usize> Kernel for BackwardPass<'_, '_, D> {
    #[inline(always)]
    fn run<S: Simd>(self, simd: S) {
        *self.1 = self.0.backward(simd);
    }
}
