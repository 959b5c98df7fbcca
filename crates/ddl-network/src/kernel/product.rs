//! Products of row-major matrices.

use crate::kernel::columns::{MatrixColumns, MatrixColumnsMut, load, load_as, store, store_as};
use ddl_simd::{LANES, Lanes, Simd};
use fearless_simd::prelude::*;

/// Columns of a block.
pub(super) const BLOCK: usize = 2 * LANES;

/// A matrix in blocks of 32 columns: all rows of the first block, then those of the next; padded with zeros.
#[derive(Clone, Debug)]
pub(super) struct Matrix {
    rows: usize,
    pairs: Vec<[Lanes; 2]>,
}

/// Some rows of some blocks of a [`Matrix`].
#[derive(Clone, Copy, Debug)]
pub(super) struct MatrixPart<'a> {
    pairs: &'a [[Lanes; 2]],
    rows_of_whole: usize,
    first: usize,
    count: usize,
}

/// What a product is added to.
#[derive(Clone, Copy, Debug)]
pub(super) enum Start<'a> {
    /// The same numbers in every row.
    Row(&'a [Lanes]),
    Zero,
    /// The values already in memory.
    There,
}

/// What becomes of a sum at its end.
#[derive(Clone, Copy, Debug)]
pub(super) enum End {
    Unchanged,
    /// max(0, sum).
    Relu,
}

impl Matrix {
    pub(super) fn zeros(rows: usize, columns: usize) -> Self {
        Self { rows, pairs: vec![[Lanes::ZERO; 2]; rows * columns.div_ceil(BLOCK)] }
    }

    pub(super) fn set(&mut self, row: usize, column: usize, value: f32) {
        let pair = &mut self.pairs[column / BLOCK * self.rows + row];
        pair[column / LANES % 2].0[column % LANES] = value;
    }

    pub(super) fn whole(&self) -> MatrixPart<'_> {
        MatrixPart { pairs: &self.pairs, rows_of_whole: self.rows, first: 0, count: self.rows }
    }

    /// All rows of 32 columns.
    #[inline(always)]
    pub(super) fn block(&self, block: usize) -> MatrixPart<'_> {
        MatrixPart { pairs: &self.pairs[block * self.rows..][..self.rows], ..self.whole() }
    }

    /// `count` rows from `first` on.
    #[inline(always)]
    pub(super) fn rows(&self, first: usize, count: usize) -> MatrixPart<'_> {
        MatrixPart { first, count, ..self.whole() }
    }
}

/// y = end(start + A B).
/// A `[rows, t]`, B `[t, columns]`, y `[rows, columns]`.
#[inline(always)]
pub(super) fn multiply<S: Simd, const R: usize, const V: usize>(
    simd: S,
    a: MatrixColumns<'_>,
    b: MatrixPart<'_>,
    (start, end): (Start<'_>, End),
    y: &mut MatrixColumnsMut<'_>,
) {
    let rows = a.rows;
    assert_eq!(rows, y.rows, "rows of a product");
    for (column, pairs) in b.pairs.chunks_exact(b.rows_of_whole).enumerate() {
        for part in (0..2).step_by(V) {
            let vector = 2 * column + part;
            // The blocks are padded to two vectors; a narrow y has only one.
            if vector * LANES >= y.count {
                break;
            }
            let b = (&pairs[b.first..][..b.count], part);
            let whole = (vector + V) * LANES <= y.count;
            let mut row = 0;
            while whole && row + R <= rows {
                tile::<S, R, V, true>(simd, a, b, (start, end), y, (row, vector));
                row += R;
            }
            while row + R <= rows {
                tile::<S, R, V, false>(simd, a, b, (start, end), y, (row, vector));
                row += R;
            }
            while R > 4 && row + 4 <= rows {
                tile::<S, 4, V, false>(simd, a, b, (start, end), y, (row, vector));
                row += 4;
            }
            while row < rows {
                tile::<S, 1, V, false>(simd, a, b, (start, end), y, (row, vector));
                row += 1;
            }
        }
    }
}

/// The product of some rows and V vectors of columns. They are the vectors of `pairs` from `part` on, and the vectors
/// of y from `vector` on.
#[inline(always)]
fn tile<S: Simd, const R: usize, const V: usize, const WHOLE: bool>(
    simd: S,
    a: MatrixColumns<'_>,
    (pairs, part): (&[[Lanes; 2]], usize),
    (start, end): (Start<'_>, End),
    y: &mut MatrixColumnsMut<'_>,
    (row, vector): (usize, usize),
) {
    let mut of_a: [&[f32]; R] = [&[]; R];
    for r in 0..R {
        of_a[r] = &a.row(row + r)[..pairs.len()];
    }
    let mut sum = [[simd.splat(0.0); V]; R];
    for r in 0..R {
        for v in 0..V {
            sum[r][v] = match start {
                Start::Row(numbers) => simd.load(&numbers[vector + v].0),
                Start::Zero => simd.splat(0.0),
                Start::There => load_as::<S, WHOLE>(simd, y.row_mut(row + r), (vector + v) * LANES),
            };
        }
    }
    for (t, of_row) in pairs.iter().enumerate() {
        let mut of_b = [simd.splat(0.0); V];
        for v in 0..V {
            of_b[v] = simd.load(&of_row[part + v].0);
        }
        for r in 0..R {
            let of_a = simd.splat(of_a[r][t]);
            for v in 0..V {
                sum[r][v] = of_a.mul_add(of_b[v], sum[r][v]);
            }
        }
    }
    for r in 0..R {
        for v in 0..V {
            if let End::Relu = end {
                sum[r][v] = simd.splat(0.0).max(sum[r][v]);
            }
            store_as::<S, WHOLE>(simd, sum[r][v], y.row_mut(row + r), (vector + v) * LANES);
        }
    }
}

/// Adds A^T B.
/// A `[t, rows]`, B `[t, columns]`, sum `[rows, columns]`.
#[inline(always)]
pub(super) fn add_transposed_product<S: Simd, const R: usize, const V: usize>(
    simd: S,
    a: MatrixColumns<'_>,
    rows: usize,
    b: MatrixColumns<'_>,
    columns: usize,
    sum: &mut [f32],
) {
    assert_eq!(a.rows, b.rows, "rows of a product");
    assert_eq!(b.count, columns, "columns of a product");
    assert_eq!(sum.len(), rows * columns, "entries of a product");
    let sum = &mut MatrixColumnsMut::whole(sum, columns);
    for first in (0..columns).step_by(V * LANES) {
        let whole = first + V * LANES <= columns;
        let mut row = 0;
        while whole && row + R <= rows {
            transposed_tile::<S, R, V, true>(simd, a, b, sum, (row, first));
            row += R;
        }
        while row + R <= rows {
            transposed_tile::<S, R, V, false>(simd, a, b, sum, (row, first));
            row += R;
        }
        while row < rows {
            transposed_tile::<S, 1, V, false>(simd, a, b, sum, (row, first));
            row += 1;
        }
    }
}

/// Adds A^T B for R columns of A from `row` on, and V vectors of B from number `first` on.
#[inline(always)]
fn transposed_tile<S: Simd, const R: usize, const V: usize, const WHOLE: bool>(
    simd: S,
    a: MatrixColumns<'_>,
    b: MatrixColumns<'_>,
    sums: &mut MatrixColumnsMut<'_>,
    (row, first): (usize, usize),
) {
    let mut sum = [[simd.splat(0.0); V]; R];
    for t in 0..a.rows {
        let of_a: &[f32; R] = a.row(t)[row..].first_chunk().expect("as many columns");
        let of_row = b.row(t);
        let mut of_b = [simd.splat(0.0); V];
        for v in 0..V {
            of_b[v] = load_as::<S, WHOLE>(simd, of_row, first + v * LANES);
        }
        for r in 0..R {
            let of_a = simd.splat(of_a[r]);
            for v in 0..V {
                sum[r][v] = of_a.mul_add(of_b[v], sum[r][v]);
            }
        }
    }
    for r in 0..R {
        let into = sums.row_mut(row + r);
        for v in 0..V {
            // Added at the end, because partial sums have smaller rounding errors than one long sum.
            let column = first + v * LANES;
            let total = load_as::<S, WHOLE>(simd, into, column) + sum[r][v];
            store_as::<S, WHOLE>(simd, total, into, column);
        }
    }
}

/// Adds the sum of the rows to `sums`.
#[inline(always)]
pub(super) fn sum_of_rows<S: Simd>(simd: S, rows: MatrixColumns<'_>, sums: &mut [f32]) {
    for column in (0..sums.len()).step_by(LANES) {
        let mut sum = simd.splat(0.0);
        for row in 0..rows.rows {
            sum += load(simd, rows.row(row), column);
        }
        store(simd, load(simd, sums, column) + sum, sums, column);
    }
}
