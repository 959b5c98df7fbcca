//! Tokens of the kernels: plain numbers, with the gradient that has come back to them.

use crate::kernel::Buffer;
use std::cell::RefCell;
use std::ops::Deref;

/// Numbers `[B, P, width]`, and what has come back to them so far.
#[derive(Debug)]
pub struct Rows {
    shape: [usize; 3],
    numbers: Buffer,
    gradient: RefCell<Option<Buffer>>,
}

impl Deref for Rows {
    type Target = [f32];

    fn deref(&self) -> &[f32] {
        &self.numbers
    }
}

impl Rows {
    /// Tokens of that shape.
    ///
    /// # Panics
    /// When the numbers are more or fewer.
    pub fn new(shape: [usize; 3], numbers: Buffer) -> Self {
        assert_eq!(
            numbers.len(),
            shape.iter().product::<usize>(),
            "numbers of {shape:?}"
        );
        Self {
            shape,
            numbers,
            gradient: RefCell::new(None),
        }
    }

    /// B, P and the width.
    pub fn shape(&self) -> [usize; 3] {
        self.shape
    }

    /// Adds to their gradient.
    pub fn add_gradient(&self, terms: Buffer) {
        let mut gradient = self.gradient.borrow_mut();
        match &mut *gradient {
            Some(sums) => add(sums, &terms),
            None => *gradient = Some(terms),
        }
    }

    /// Adds to the gradient of what starts at the number `first`.
    pub(super) fn add_gradient_at(&self, first: usize, terms: &[f32]) {
        let mut gradient = self.gradient.borrow_mut();
        let sums = gradient.get_or_insert_with(|| Buffer::zeros(self.numbers.len()));
        add(&mut sums[first..], terms);
    }

    pub(super) fn take_gradient(&self) -> Option<Buffer> {
        self.gradient.take()
    }
}

fn add(sums: &mut [f32], terms: &[f32]) {
    for (sum, term) in sums.iter_mut().zip(terms) {
        *sum += term;
    }
}
