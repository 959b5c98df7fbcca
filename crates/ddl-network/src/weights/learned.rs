//! Learned numbers, and what they are called.

use super::layout::{Layout, TensorLayout};
use crate::NetworkError;
use rand_chacha::ChaCha8Rng;
use std::sync::Arc;

/// The learned numbers of a network, in the order of their [`Layout`].
#[derive(Debug, Clone, PartialEq)]
pub struct Weights {
    layout: Arc<Layout>,
    numbers: Vec<f32>,
}

impl Weights {
    /// Numbers in the order of the layout.
    ///
    /// # Panics
    /// When there are more or fewer numbers than the layout has.
    pub fn new(layout: Arc<Layout>, numbers: Vec<f32>) -> Self {
        assert_eq!(numbers.len(), layout.count(), "numbers of this layout");
        Self { layout, numbers }
    }

    /// Initial numbers, drawn in the order of the tensors; the same on every machine.
    pub fn initial(layout: &Arc<Layout>, rng: ChaCha8Rng) -> Self {
        let numbers = layout.initial(rng).into_iter().map(|x| x as f32);
        Self::new(Arc::clone(layout), numbers.collect())
    }

    /// Checks that they are of this layout.
    ///
    /// # Errors
    /// [`NetworkError::Shape`] when they are of another one.
    pub fn ensure_of(&self, layout: &Arc<Layout>) -> Result<(), NetworkError> {
        if Arc::ptr_eq(&self.layout, layout) || self.layout == *layout {
            return Ok(());
        }
        let (wanted, got) = (layout.count(), self.count());
        Err(NetworkError::shape(
            "weights",
            format!("those of this network, {wanted} numbers"),
            format!("{got} numbers of another one"),
        ))
    }

    /// Names, shapes and places.
    pub fn layout(&self) -> &Arc<Layout> {
        &self.layout
    }

    /// How many numbers there are.
    pub fn count(&self) -> usize {
        self.numbers.len()
    }

    /// All numbers, tensor after tensor.
    pub fn numbers(&self) -> &[f32] {
        &self.numbers
    }

    /// Each tensor with its numbers, row by row.
    pub fn iter(&self) -> impl Iterator<Item = (&TensorLayout, &[f32])> {
        let tensors = self.layout.tensors().iter();
        tensors.map(|tensor| (tensor, &self.numbers[tensor.span()]))
    }
}
