//! Columns of row-major matrices, and vectors of a row in registers.

use ddl_simd::{LANES, Simd};

/// Adjacent columns of a matrix, all or some.
#[derive(Clone, Copy, Debug)]
pub(super) struct MatrixColumns<'a> {
    numbers: &'a [f32],
    rows: usize,
    /// Length of a row of the whole matrix.
    stride: usize,
    first: usize,
    count: usize,
}

pub(super) struct MatrixColumnsMut<'a> {
    numbers: &'a mut [f32],
    rows: usize,
    stride: usize,
    first: usize,
    count: usize,
}

impl<'a> MatrixColumns<'a> {
    pub(super) fn whole(numbers: &'a [f32], count: usize) -> Self {
        Self::part(numbers, count, 0, count)
    }

    /// `count` columns from `first` on, of a matrix with rows of `stride` numbers.
    pub(super) fn part(numbers: &'a [f32], stride: usize, first: usize, count: usize) -> Self {
        assert!(
            numbers.len().is_multiple_of(stride) && first + count <= stride,
            "columns {first} to {} of {} numbers in rows of {stride}",
            first + count,
            numbers.len()
        );
        Self {
            numbers,
            rows: numbers.len() / stride,
            stride,
            first,
            count,
        }
    }

    #[inline(always)]
    pub(super) fn rows(&self) -> usize {
        self.rows
    }

    #[inline(always)]
    pub(super) fn row(&self, row: usize) -> &'a [f32] {
        &self.numbers[row * self.stride + self.first..][..self.count]
    }
}

impl<'a> MatrixColumnsMut<'a> {
    pub(super) fn whole(numbers: &'a mut [f32], count: usize) -> Self {
        Self::part(numbers, count, 0, count)
    }

    pub(super) fn part(numbers: &'a mut [f32], stride: usize, first: usize, count: usize) -> Self {
        let rows = MatrixColumns::part(numbers, stride, first, count).rows;
        Self {
            numbers,
            rows,
            stride,
            first,
            count,
        }
    }

    #[inline(always)]
    pub(super) fn rows(&self) -> usize {
        self.rows
    }

    #[inline(always)]
    pub(super) fn count(&self) -> usize {
        self.count
    }

    #[inline(always)]
    pub(super) fn row_mut(&mut self, row: usize) -> &mut [f32] {
        &mut self.numbers[row * self.stride + self.first..][..self.count]
    }
}

/// Sixteen numbers of a row from `first`; numbers beyond its end are 0.
#[inline(always)]
pub(super) fn load<S: Simd>(simd: S, row: &[f32], first: usize) -> S::Floats {
    match row.get(first..first + LANES) {
        Some(whole) => simd.load(&whole.as_chunks().0[0]),
        None => simd.load(&end(row, first)),
    }
}

/// Writes sixteen numbers to a row from `first`; drops those beyond its end.
#[inline(always)]
pub(super) fn store<S: Simd>(simd: S, value: S::Floats, row: &mut [f32], first: usize) {
    if let Some(whole) = row.get_mut(first..first + LANES) {
        simd.store(value, &mut whole.as_chunks_mut().0[0]);
    } else {
        let mut numbers = [0.0; LANES];
        simd.store(value, &mut numbers);
        store_end(&numbers, row, first);
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
