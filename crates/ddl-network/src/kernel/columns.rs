//! Columns of row-major matrices, and vectors of a row in registers.

use ddl_simd::{Floats, LANES, Simd};

/// The first columns of a matrix, or all.
#[derive(Clone, Copy, Debug)]
pub(super) struct MatrixColumns<'a> {
    numbers: &'a [f32],
    pub(super) rows: usize,
    /// Length of a row of the whole matrix.
    stride: usize,
    pub(super) count: usize,
}

/// A whole matrix whose numbers are overwritten or added to.
pub(super) struct MatrixColumnsMut<'a> {
    numbers: &'a mut [f32],
    pub(super) rows: usize,
    pub(super) count: usize,
}

impl<'a> MatrixColumns<'a> {
    pub(super) fn whole(numbers: &'a [f32], count: usize) -> Self {
        Self::first(numbers, count, count)
    }

    /// The first `count` columns of a matrix with rows of `stride` numbers.
    pub(super) fn first(numbers: &'a [f32], stride: usize, count: usize) -> Self {
        assert!(
            numbers.len().is_multiple_of(stride) && count <= stride,
            "{count} columns of {} numbers in rows of {stride}",
            numbers.len()
        );
        Self { numbers, rows: numbers.len() / stride, stride, count }
    }

    #[inline(always)]
    pub(super) fn row(&self, row: usize) -> &'a [f32] {
        &self.numbers[row * self.stride..][..self.count]
    }
}

impl<'a> MatrixColumnsMut<'a> {
    pub(super) fn whole(numbers: &'a mut [f32], count: usize) -> Self {
        let rows = MatrixColumns::whole(numbers, count).rows;
        Self { numbers, rows, count }
    }

    #[inline(always)]
    pub(super) fn row_mut(&mut self, row: usize) -> &mut [f32] {
        &mut self.numbers[row * self.count..][..self.count]
    }
}

/// Sixteen numbers of a row from `first`; numbers beyond its end are 0.
#[inline(always)]
pub(super) fn load<S: Simd>(simd: S, row: &[f32], first: usize) -> Floats<S> {
    match row.get(first..first + LANES) {
        Some(whole) => simd.load(&whole.as_chunks().0[0]),
        None => simd.load(&end(row, first)),
    }
}

/// [`load`] where `WHOLE` says that no number is beyond the end. In loops, the call for the end of a row would move
/// accumulators from registers to memory, even if it is never made.
#[inline(always)]
pub(super) fn load_as<S: Simd, const WHOLE: bool>(simd: S, row: &[f32], first: usize) -> Floats<S> {
    if WHOLE { simd.load(row[first..].first_chunk().expect("a whole vector")) } else { load(simd, row, first) }
}

/// Writes sixteen numbers to a row from `first`; drops those beyond its end.
#[inline(always)]
pub(super) fn store<S: Simd>(simd: S, value: Floats<S>, row: &mut [f32], first: usize) {
    if let Some(whole) = row.get_mut(first..first + LANES) {
        simd.store(value, &mut whole.as_chunks_mut().0[0]);
    } else {
        let mut numbers = [0.0; LANES];
        simd.store(value, &mut numbers);
        store_end(&numbers, row, first);
    }
}

/// [`store`] where `WHOLE` says that no number is beyond the end.
#[inline(always)]
pub(super) fn store_as<S: Simd, const WHOLE: bool>(simd: S, value: Floats<S>, row: &mut [f32], first: usize) {
    if WHOLE {
        simd.store(value, row[first..].first_chunk_mut().expect("a whole vector"));
    } else {
        store(simd, value, row, first);
    }
}

#[cold]
fn end(row: &[f32], first: usize) -> [f32; LANES] {
    let mut numbers = [0.0; LANES];
    let rest = row.get(first..).unwrap_or_default();
    numbers[..rest.len()].copy_from_slice(rest);
    numbers
}

#[cold]
fn store_end(numbers: &[f32; LANES], row: &mut [f32], first: usize) {
    let rest = row.get_mut(first..).unwrap_or_default();
    rest.copy_from_slice(&numbers[..rest.len()]);
}
