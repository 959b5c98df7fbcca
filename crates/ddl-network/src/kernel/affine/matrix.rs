//! Weights as products read them.

use ddl_simd::{LANES, Lanes};

/// 32 columns of all rows together, then the next 32; padded with zeros.
#[derive(Clone, Debug)]
pub(super) struct Matrix {
    pub(super) rows: usize,
    pub(super) pairs: Vec<[Lanes; 2]>,
}

/// What a product is added to.
#[derive(Clone, Copy, Debug)]
pub(super) enum Start<'a> {
    /// In every row the same numbers.
    Row(&'a [Lanes]),
    Zero,
    /// What is there already.
    There,
}

impl Matrix {
    pub(super) fn zeros(rows: usize, columns: usize) -> Self {
        Self {
            rows,
            pairs: vec![[Lanes::ZERO; 2]; rows * columns.div_ceil(2 * LANES)],
        }
    }

    pub(super) fn set(&mut self, row: usize, column: usize, value: f32) {
        let pair = &mut self.pairs[column / (2 * LANES) * self.rows + row];
        pair[column / LANES % 2].0[column % LANES] = value;
    }
}
