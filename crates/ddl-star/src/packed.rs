//! The weights of a layer as its kernel reads them, kept from one pass to the next.

use std::cell::RefCell;
use std::ops::Range;
use std::sync::Arc;

use crate::kernel;
use crate::pass::Pass;

/// A kernel with weights.
pub(crate) trait Weighted: Clone {
    /// Takes over the learned numbers of its layer.
    fn update(&mut self, weights: &[f32]);
}

impl Weighted for kernel::EncoderLayer {
    fn update(&mut self, weights: &[f32]) {
        Self::update(self, weights);
    }
}

impl Weighted for kernel::Linear {
    fn update(&mut self, weights: &[f32]) {
        Self::update(self, weights);
    }
}

/// The kernel of a layer, once it was needed.
#[derive(Debug)]
pub(crate) struct Packed<K> {
    /// Where the layer's numbers stand among all learned ones.
    span: Range<usize>,
    /// With the version of the weights that it has taken over.
    latest: RefCell<Option<(i64, Arc<K>)>>,
}

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
        let (version, kernel) =
            latest.get_or_insert_with(|| (weights.version - 1, Arc::new(zeros())));
        if *version != weights.version {
            // In place, unless another pass still goes by the weights of before.
            Arc::make_mut(kernel).update(&weights.numbers(self.span.clone()));
            *version = weights.version;
        }
        Arc::clone(kernel)
    }
}
