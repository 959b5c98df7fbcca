//! Scores and gradients of a block of sixteen sequences against one, in `f32` and the exponential domain.
//!
//! With α(i, j) = R(i, j), the sum over the paths to a cell, and β(i, j), the sum over the paths from it to the end
//! without its own factor K(i, j), the expected alignment is E(i, j) = α(i, j) β(i, j) / R(n, m).

#![expect(clippy::inline_always, reason = "the lanes must stay in registers")]

use ddl_simd::{LANES, Lanes, Register, RegisterKernel};

use crate::blocks::Step;
use crate::recursion::{GROUP, cell, similarities_of_row, weigh};

/// Added to α / R(n, m): 2^−120. Its product with β is negligible relative to the seed of β.
const NEGLIGIBLE: f32 = f32::from_bits((127 - 120) << 23);

/// The results for a block and the working memory, which is reused for the next block.
#[derive(Debug)]
pub(super) struct Working<const D: usize> {
    /// R(n, m), start value included.
    pub(super) scores: [f32; LANES],
    /// `Σ_j E(i, j) (x_i − y_j)` for every step and component, in scaled units.
    pub(super) gradient: Vec<[Lanes; D]>,
    k: Vec<Lanes>,
    alpha: Vec<Lanes>,
}

impl<const D: usize> Working<D> {
    pub(super) fn new() -> Self {
        Self {
            scores: [0.0; LANES],
            gradient: Vec::new(),
            k: Vec::new(),
            alpha: Vec::new(),
        }
    }

    fn resize(&mut self, n: usize, m: usize) {
        self.gradient.resize(n, [Lanes::ZERO; D]);
        self.k.resize(n * m, Lanes::ZERO);
        self.alpha.resize(n * m, Lanes::ZERO);
    }
}

pub(super) struct ForwardBackward<'a, const D: usize> {
    pub(super) x: &'a [[f32; D]],
    pub(super) block: &'a [Step<D>],
    /// Start value of the recursion, a power of two.
    pub(super) start: f32,
    /// The value of β at the end of the paths, a power of two.
    pub(super) seed: f32,
    pub(super) working: &'a mut Working<D>,
}

impl<const D: usize> RegisterKernel for ForwardBackward<'_, D> {
    type Output = ();

    #[inline(always)]
    fn run<S: Register>(mut self, simd: S) {
        self.working.resize(self.x.len(), self.block.len());
        let zero = simd.splat(0.0);
        // Rows stay in registers if the compiler knows their length.
        if let Ok(block) = <&[Step<D>; 7]>::try_from(self.block) {
            self.parts::<S, 7>(simd, block, &mut [zero; 7]);
        } else if let Ok(block) = <&[Step<D>; 8]>::try_from(self.block) {
            self.parts::<S, 8>(simd, block, &mut [zero; 8]);
        } else {
            self.parts::<S, GROUP>(simd, self.block, &mut vec![zero; self.block.len()]);
        }
    }
}

impl<const D: usize> ForwardBackward<'_, D> {
    #[inline(always)]
    fn parts<S: Register, const G: usize>(&mut self, simd: S, block: &[Step<D>], row: &mut [S::Floats]) {
        for part in 0..S::PARTS {
            let score = self.forward::<S, G>(simd, block, part, row);
            simd.store(score, &mut self.working.scores, part);
            self.backward(simd, block, part, score, row);
        }
    }

    /// The recursion; it stores K and α of every cell.
    #[inline(always)]
    fn forward<S: Register, const G: usize>(
        &mut self,
        simd: S,
        block: &[Step<D>],
        part: usize,
        row: &mut [S::Floats],
    ) -> S::Floats {
        let zero = simd.splat(0.0);
        let Working { k, alpha, .. } = &mut *self.working;
        let m = block.len();
        row.fill(zero);
        let mut corner = simd.splat(self.start);
        let mut left = zero;
        let rows = k.chunks_exact_mut(m).zip(alpha.chunks_exact_mut(m));
        for (x, (k, alpha)) in self.x.iter().zip(rows) {
            similarities_of_row::<S, D, G>(simd, x, block, part, k);
            let mut diagonal = corner;
            left = zero;
            for j in 0..m {
                let up = row[j];
                left = cell(simd, simd.load(&k[j].0, part), diagonal, up, left);
                row[j] = left;
                simd.store(left, &mut alpha[j].0, part);
                diagonal = up;
            }
            corner = zero;
        }
        left
    }

    /// β of every cell from the last to the first, and with it the gradient. The numbers added to both products keep
    /// them from becoming denormal.
    #[inline(always)]
    fn backward<S: Register>(
        &mut self,
        simd: S,
        block: &[Step<D>],
        part: usize,
        score: S::Floats,
        row: &mut [S::Floats],
    ) {
        let zero = simd.splat(0.0);
        let (one, negligible) = (simd.splat(1.0), simd.splat(NEGLIGIBLE));
        let inverse = simd.div(one, score);
        let unit = simd.splat(1.0 / self.seed);
        let Working { k, alpha, gradient, .. } = &mut *self.working;
        let m = block.len();
        // row[j] holds K β of cell (i + 1, j).
        row.fill(zero);
        // The last cell receives the seed as the end of the paths.
        let mut end = simd.splat(self.seed);
        let rows = k.chunks_exact(m).zip(alpha.chunks_exact(m));
        let steps = self.x.iter().zip(gradient);
        for ((x, gradient), (k, alpha)) in steps.zip(rows).rev() {
            let mut sums = [zero; D];
            let mut right = end;
            end = zero;
            let mut diagonal = zero;
            for j in (0..m).rev() {
                let down = row[j];
                let beta = simd.add(simd.add(diagonal, down), right);
                let share = simd.mul_add(simd.load(&alpha[j].0, part), inverse, negligible);
                let expected = simd.mul_add(share, beta, one);
                for d in 0..D {
                    let y = simd.load(&block[j][d].0, part);
                    let difference = simd.sub(simd.splat(x[d]), y);
                    sums[d] = simd.mul_add(expected, difference, sums[d]);
                }
                right = weigh(simd, simd.load(&k[j].0, part), beta);
                row[j] = right;
                diagonal = down;
            }
            for d in 0..D {
                simd.store(simd.mul(sums[d], unit), &mut gradient[d].0, part);
            }
        }
    }
}
