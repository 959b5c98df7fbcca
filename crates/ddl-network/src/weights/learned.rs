//! The weights of a network with their names.

use crate::NetworkError;
use crate::seed::{Stage, stream};
use crate::weights::layout::{Layout, TensorLayout};
use rand_chacha::ChaCha8Rng;
use std::sync::Arc;

/// The weights of a network, in the order of their [`Layout`].
#[derive(Debug, Clone, PartialEq)]
pub struct Weights {
    layout: Arc<Layout>,
    numbers: Vec<f32>,
}

impl Weights {
    /// Weights from numbers in the order of the layout.
    ///
    /// # Panics
    /// If the count of `numbers` differs from the layout's.
    pub fn new(layout: Arc<Layout>, numbers: Vec<f32>) -> Self {
        assert_eq!(numbers.len(), layout.count(), "number of weights");
        Self { layout, numbers }
    }

    /// The initial weights of a network with this seed; the same on every machine.
    pub fn seeded(layout: &Arc<Layout>, seed: u64) -> Self {
        Self::initial(layout, stream(seed, Stage::Weights, 0))
    }

    /// Initial weights, drawn in the order of the tensors.
    pub(crate) fn initial(layout: &Arc<Layout>, rng: ChaCha8Rng) -> Self {
        let numbers = layout.initial(rng).into_iter().map(|x| x as f32);
        Self::new(Arc::clone(layout), numbers.collect())
    }

    /// Checks that the weights have this layout.
    ///
    /// # Errors
    /// [`NetworkError::Shape`] if they have another one.
    pub fn check_layout(&self, layout: &Arc<Layout>) -> Result<(), NetworkError> {
        if Arc::ptr_eq(&self.layout, layout) || self.layout == *layout {
            return Ok(());
        }
        let (wanted, got) = (layout.count(), self.numbers.len());
        Err(NetworkError::shape(
            "weights",
            format!("the {wanted} weights of this network"),
            format!("{got} weights of another network"),
        ))
    }

    /// Names, shapes and positions of the tensors.
    pub fn layout(&self) -> &Arc<Layout> {
        &self.layout
    }

    /// All weights, tensor after tensor.
    pub fn numbers(&self) -> &[f32] {
        &self.numbers
    }

    /// Each tensor with its numbers in row-major order.
    pub fn iter(&self) -> impl Iterator<Item = (&TensorLayout, &[f32])> {
        self.layout.tensors().iter().map(|tensor| (tensor, &self.numbers[tensor.span()]))
    }
}
