//! The weights of a layer as its kernel reads them, kept from one pass to the next.

use std::cell::RefCell;
use std::ops::Range;
use std::sync::Arc;

use crate::kernel;
use crate::pass::Pass;
use crate::precision::Precision;

/// A kernel with weights.
pub(crate) trait Weighted: Clone {
    /// Takes over the learned numbers of its layer, for products in that precision.
    fn update(&mut self, weights: &[f32], precision: Precision);
}

impl Weighted for kernel::EncoderLayer {
    fn update(&mut self, weights: &[f32], precision: Precision) {
        Self::update(self, weights, precision);
    }
}

impl Weighted for kernel::Linear {
    fn update(&mut self, weights: &[f32], _: Precision) {
        Self::update(self, weights);
    }
}

/// The kernel of a layer, once it was needed.
#[derive(Debug)]
pub(crate) struct Packed<K> {
    /// Where the layer's numbers stand among all learned ones.
    span: Range<usize>,
    latest: RefCell<Option<(Version, Arc<K>)>>,
}

/// Of the weights that a kernel has taken over, and in which precision.
type Version = (i64, Precision);

impl<K: Weighted> Packed<K> {
    pub(crate) fn new(span: Range<usize>) -> Self {
        Self {
            span,
            latest: RefCell::new(None),
        }
    }

    /// Where the layer's numbers stand among all learned ones.
    pub(crate) fn span(&self) -> Range<usize> {
        self.span.clone()
    }

    /// The kernel with the weights of `pass`; `zeros` makes it the first time.
    pub(crate) fn of(&self, pass: &Pass, zeros: impl FnOnce() -> K) -> Arc<K> {
        let mut latest = self.latest.borrow_mut();
        let weights = pass.weights();
        let wanted = (weights.version, weights.precision);
        let (taken, kernel) = latest.get_or_insert_with(|| {
            let none = (weights.version - 1, weights.precision);
            (none, Arc::new(zeros()))
        });
        if *taken != wanted {
            // In place, unless another pass still goes by the weights of before.
            Arc::make_mut(kernel).update(&weights.numbers(self.span.clone()), weights.precision);
            *taken = wanted;
        }
        Arc::clone(kernel)
    }
}
