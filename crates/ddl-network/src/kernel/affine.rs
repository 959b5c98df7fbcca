//! Affine maps of rows: projections before and after attention, embeddings, fusion of tokens.

use crate::kernel::columns::{MatrixColumns, MatrixColumnsMut};
use crate::kernel::product::{BLOCK, End, Matrix, Start, add_transposed_product, multiply, sum_of_rows};
use ddl_simd::{LANES, Lanes, Simd};

/// y = W x + b. The weights are stored for the forward and for the backward pass.
#[derive(Clone, Debug)]
pub(super) struct Affine {
    pub(super) inputs: usize,
    pub(super) outputs: usize,
    /// W^T, `[inputs, outputs]`.
    pub(super) transposed: Matrix,
    /// W, `[outputs, inputs]`.
    pub(super) weight: Matrix,
    /// Padded with zeros to a whole block.
    pub(super) bias: Vec<Lanes>,
}

impl Affine {
    pub(super) fn new(inputs: usize, outputs: usize) -> Self {
        assert!(inputs > 0 && outputs > 0, "a width of 0");
        Self {
            inputs,
            outputs,
            transposed: Matrix::zeros(inputs, outputs),
            weight: Matrix::zeros(outputs, inputs),
            bias: vec![Lanes::ZERO; outputs.div_ceil(BLOCK) * 2],
        }
    }

    /// `weight` `[outputs, inputs]`, `bias` `[outputs]`.
    pub(super) fn update(&mut self, weight: &[f32], bias: &[f32]) {
        assert_eq!(weight.len(), self.outputs * self.inputs, "entries of W");
        assert_eq!(bias.len(), self.outputs, "entries of b");
        for (o, row) in weight.chunks_exact(self.inputs).enumerate() {
            for (i, &value) in row.iter().enumerate() {
                self.weight.set(o, i, value);
                self.transposed.set(i, o, value);
            }
        }
        for (lanes, values) in self.bias.iter_mut().zip(bias.chunks(LANES)) {
            lanes.0[..values.len()].copy_from_slice(values);
        }
    }

    /// y for every row of x.
    /// `x` `[rows, inputs]` -> `y` `[rows, outputs]`, overwritten. If `y` is wider, up to a whole vector, the columns
    /// after the outputs have no meaning.
    #[inline(always)]
    pub(super) fn forward<S: Simd, const R: usize, const V: usize>(
        &self,
        simd: S,
        x: MatrixColumns<'_>,
        y: &mut MatrixColumnsMut<'_>,
    ) {
        multiply::<S, R, V>(simd, x, self.transposed.whole(), (Start::Row(&self.bias), End::Unchanged), y);
    }

    /// W^T gy for every row. It overwrites `gx`, or is added to it if `add`.
    /// `gy` `[rows, outputs]` -> `gx` `[rows, inputs]`.
    #[inline(always)]
    pub(super) fn backward<S: Simd, const R: usize, const V: usize>(
        &self,
        simd: S,
        gy: MatrixColumns<'_>,
        gx: &mut MatrixColumnsMut<'_>,
        add: bool,
    ) {
        let start = if add { Start::There } else { Start::Zero };
        multiply::<S, R, V>(simd, gy, self.weight.whole(), (start, End::Unchanged), gx);
    }

    /// Adds the gradients of the weights.
    /// `x` `[rows, inputs]`, `gy` `[rows, outputs]` -> `weight` `[outputs, inputs]`, `bias` `[outputs]`.
    #[inline(always)]
    pub(super) fn add_gradients<S: Simd, const R: usize, const V: usize>(
        &self,
        simd: S,
        x: MatrixColumns<'_>,
        gy: MatrixColumns<'_>,
        [weight, bias]: [&mut [f32]; 2],
    ) {
        add_transposed_product::<S, R, V>(simd, gy, self.outputs, x, self.inputs, weight);
        sum_of_rows(simd, gy, bias);
    }
}
