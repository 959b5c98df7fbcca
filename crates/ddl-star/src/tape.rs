//! Gradients through kernels of our own, which libtorch does not know.
//!
//! A kernel leaves on the tape how the gradients of its output become those of its inputs and weights. Where tokens go over
//! to libtorch they become a leaf of its graph: backwards, libtorch comes first, then the tape, from its end.

use std::cell::RefCell;

/// One kernel backwards; it adds to the gradients of all learned numbers.
type Backward = Box<dyn FnOnce(&mut [f32])>;

/// The kernels of one forward pass, in the order in which they ran.
#[derive(Default)]
pub(crate) struct Tape {
    steps: RefCell<Vec<Backward>>,
}

impl std::fmt::Debug for Tape {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "Tape of {} steps", self.steps.borrow().len())
    }
}

impl Tape {
    pub(crate) fn push(&self, step: impl FnOnce(&mut [f32]) + 'static) {
        self.steps.borrow_mut().push(Box::new(step));
    }

    /// Adds to the gradients of all learned numbers, from what libtorch has given back. The tape is empty then.
    pub(crate) fn backward(&self, of_weights: &mut [f32]) {
        for step in self.steps.take().into_iter().rev() {
            step(of_weights);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_last_step_comes_first_and_only_once() {
        let tape = Tape::default();
        tape.push(|sums| sums[0] += 1.0);
        tape.push(|sums| sums[0] *= 3.0);
        let mut sums = [5.0];
        tape.backward(&mut sums);
        tape.backward(&mut sums);
        assert!((sums[0] - 16.0).abs() < 1e-6, "{sums:?}");
    }
}
