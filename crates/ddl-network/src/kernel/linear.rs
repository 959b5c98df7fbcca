//! An affine map as a separate kernel, for embeddings and the fusion of tokens.

use crate::kernel::affine::Affine;
use crate::kernel::buffer::{Buffer, add_to};
use crate::kernel::columns::{MatrixColumns, MatrixColumnsMut};
use crate::kernel::threads::run_each;
use ddl_simd::{Dispatch, LANES, Simd, TiledKernel};

/// Rows that are computed together. The constant number makes sums over rows independent of the threads.
const ROWS: usize = 512;

/// y = W x + b.
/// Results do not depend on the number of threads.
#[derive(Clone, Debug)]
pub(crate) struct LinearKernel {
    map: Affine,
    dispatch: Dispatch,
}

impl LinearKernel {
    pub(crate) fn zeros(inputs: usize, outputs: usize) -> Self {
        Self { map: Affine::new(inputs, outputs), dispatch: Dispatch::detect() }
    }

    /// Replaces the weights: W `[outputs, inputs]`, row-major, then b.
    pub(crate) fn update(&mut self, weights: &[f32]) {
        let (weight, bias) = weights.split_at(self.map.outputs * self.map.inputs);
        self.map.update(weight, bias);
    }

    /// `x` `[rows, inputs]` -> `[rows, outputs]`.
    pub(crate) fn forward(&self, x: &[f32]) -> Buffer {
        // Rows that are narrower than a vector are written as whole vectors and then put together.
        let width = self.map.outputs.max(LANES);
        let rows = x.len() / self.map.inputs;
        let mut wide = Buffer::any(rows * width);
        let inputs = x.chunks(ROWS * self.map.inputs);
        let jobs = inputs.zip(wide.chunks_mut(ROWS * width));
        let jobs = jobs.map(|(x, y)| LinearForward {
            map: &self.map,
            x: MatrixColumns::whole(x, self.map.inputs),
            y: MatrixColumnsMut::whole(y, width),
        });
        run_each(self.dispatch, jobs, x.len() * self.map.outputs);
        if width == self.map.outputs {
            return wide;
        }
        let mut y = Buffer::any(rows * self.map.outputs);
        for (row, numbers) in y.chunks_exact_mut(self.map.outputs).zip(wide.chunks_exact(width)) {
            for (to, from) in row.iter_mut().zip(numbers) {
                *to = *from;
            }
        }
        y
    }

    /// The gradient of x; the gradient of the weights is added to `of_weights`.
    pub(crate) fn backward(&self, x: &[f32], gy: &[f32], of_weights: &mut [f32]) -> Buffer {
        let mut gx = Buffer::any(x.len());
        let pieces = x.len().div_ceil(ROWS * self.map.inputs);
        let mut sums = Buffer::many_zeros(pieces, of_weights.len());
        let inputs = x.chunks(ROWS * self.map.inputs).zip(gy.chunks(ROWS * self.map.outputs));
        let outputs = gx.chunks_mut(ROWS * self.map.inputs).zip(&mut sums);
        let jobs = inputs.zip(outputs).map(|((x, gy), (gx, sums))| LinearBackward {
            map: &self.map,
            x: MatrixColumns::whole(x, self.map.inputs),
            gy: MatrixColumns::whole(gy, self.map.outputs),
            gx: MatrixColumnsMut::whole(gx, self.map.inputs),
            of_weights: sums.split_at_mut(self.map.outputs * self.map.inputs).into(),
        });
        let work = 2 * x.len() * self.map.outputs;
        run_each(self.dispatch, jobs, work);
        for sums in &sums {
            add_to(of_weights, sums);
        }
        gx
    }
}

struct LinearForward<'a> {
    map: &'a Affine,
    x: MatrixColumns<'a>,
    y: MatrixColumnsMut<'a>,
}

impl TiledKernel for LinearForward<'_> {
    #[inline(always)]
    fn run<S: Simd, const R: usize, const V: usize>(mut self, simd: S) {
        if self.y.count == LANES {
            self.map.forward::<S, R, 1>(simd, self.x, &mut self.y);
        } else {
            self.map.forward::<S, R, V>(simd, self.x, &mut self.y);
        }
    }
}

struct LinearBackward<'a> {
    map: &'a Affine,
    x: MatrixColumns<'a>,
    gy: MatrixColumns<'a>,
    gx: MatrixColumnsMut<'a>,
    of_weights: [&'a mut [f32]; 2],
}

impl TiledKernel for LinearBackward<'_> {
    #[inline(always)]
    fn run<S: Simd, const R: usize, const V: usize>(mut self, simd: S) {
        self.map.backward::<S, R, V>(simd, self.gy, &mut self.gx, false);
        self.map.add_gradients::<S, R, V>(simd, self.x, self.gy, self.of_weights);
    }
}
