//! The kernels of a forward pass, for the way back.
//!
//! A kernel leaves on the tape how the gradients of its output become those of its inputs and weights. Where tokens
//! go over to another library, its way back comes first; then the tape, from its end.

use std::cell::RefCell;

/// One kernel backwards; it adds to the gradients of all learned numbers.
type Backward = Box<dyn FnOnce(&mut [f32])>;

/// The kernels of one forward pass, in the order in which they ran.
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

    /// Adds to the gradients of all learned numbers, from those that were added to tokens. The tape is empty then.
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
