//! Tokens of the kernels with their gradients, and the tape of the backward pass. A kernel records on the tape how the
//! gradient of its output becomes those of its inputs and weights. If another library continues with the tokens, its
//! backward pass runs first, then the tape in reverse order.

use crate::kernel::{Buffer, add_to};
use std::cell::RefCell;
use std::ops::Deref;

/// Tokens `[B, P, width]`, and their gradient accumulated so far.
#[derive(Debug)]
pub struct Rows {
    shape: [usize; 3],
    numbers: Buffer,
    pub(super) gradient: RefCell<Option<Buffer>>,
}

impl Deref for Rows {
    type Target = [f32];

    fn deref(&self) -> &[f32] {
        &self.numbers
    }
}

impl Rows {
    /// Tokens of that shape, in row-major order.
    ///
    /// # Panics
    /// If the count of `numbers` does not fit the shape.
    pub fn new(shape: [usize; 3], numbers: Buffer) -> Self {
        assert_eq!(numbers.len(), shape.iter().product::<usize>(), "number of elements of the shape {shape:?}");
        Self { shape, numbers, gradient: RefCell::new(None) }
    }

    /// `[B, P, width]`.
    pub fn shape(&self) -> [usize; 3] {
        self.shape
    }

    /// Adds `terms`, of the same shape, to the gradient.
    pub fn add_gradient(&self, terms: Buffer) {
        let mut gradient = self.gradient.borrow_mut();
        match &mut *gradient {
            Some(sums) => add_to(sums, &terms),
            None => *gradient = Some(terms),
        }
    }

    pub(super) fn add_gradient_at(&self, first: usize, terms: &[f32]) {
        let mut gradient = self.gradient.borrow_mut();
        let sums = gradient.get_or_insert_with(|| Buffer::zeros(self.numbers.len()));
        add_to(&mut sums[first..], terms);
    }
}

/// The backward pass of one kernel; it adds to the gradients of all weights.
type Backward = Box<dyn FnOnce(&mut [f32])>;

#[derive(Default)]
pub(super) struct Tape {
    steps: RefCell<Vec<Backward>>,
}

impl std::fmt::Debug for Tape {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "Tape of {} steps", self.steps.borrow().len())
    }
}

impl Tape {
    pub(super) fn push(&self, step: impl FnOnce(&mut [f32]) + 'static) {
        self.steps.borrow_mut().push(Box::new(step));
    }

    pub(super) fn backward(&self, of_weights: &mut [f32]) {
        for step in self.steps.take().into_iter().rev() {
            step(of_weights);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_run_once_and_in_reverse_order() {
        let tape = Tape::default();
        tape.push(|sums| sums[0] += 1.0);
        tape.push(|sums| sums[0] *= 3.0);
        let mut sums = [5.0];
        tape.backward(&mut sums);
        tape.backward(&mut sums);
        assert!((sums[0] - 16.0).abs() < 1e-6, "{sums:?}");
    }
}
