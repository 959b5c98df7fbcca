//! Derivatives with respect to the weights.

use std::ops::DerefMut;

use super::block::BLOCK;

/// Sums of derivatives with respect to the weights, laid out as the weights that a layer takes over.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Gradients<N = Vec<f32>> {
    /// `[hidden, width]`, by rows.
    pub(crate) w1: N,
    /// `[hidden]`.
    pub(crate) b1: N,
    /// `[width, hidden]`, by rows.
    pub(crate) w2: N,
    /// `[width]`.
    pub(crate) b2: N,
}

#[cfg(test)]
impl Gradients {
    pub(crate) fn zeros(width: usize, hidden: usize) -> Self {
        Self {
            w1: vec![0.0; hidden * width],
            b1: vec![0.0; hidden],
            w2: vec![0.0; width * hidden],
            b2: vec![0.0; width],
        }
    }
}

impl<N: DerefMut<Target = [f32]>> Gradients<N> {
    /// Panics unless they are those of these widths.
    pub(super) fn check(&self, width: usize, hidden: usize) {
        assert_eq!(
            self.w1.len(),
            hidden * width,
            "entries of the gradient of W1"
        );
        assert_eq!(self.b1.len(), hidden, "entries of the gradient of b1");
        assert_eq!(
            self.w2.len(),
            width * hidden,
            "entries of the gradient of W2"
        );
        assert_eq!(self.b2.len(), width, "entries of the gradient of b2");
    }

    /// What belongs to the first `units` blocks of hidden units, to the next, and so on.
    pub(super) fn parts(&mut self, width: usize, units: usize) -> Vec<UnitGradients<'_>> {
        let hidden = self.b1.len();
        let size = units * BLOCK;
        let w1 = self.w1.chunks_mut(size * width);
        let b1 = self.b1.chunks_mut(size);
        let mut parts: Vec<_> = w1
            .zip(b1)
            .map(|(w1, b1)| UnitGradients { w1, b1, w2: vec![] })
            .collect();
        for row in self.w2.chunks_exact_mut(hidden) {
            for (part, piece) in parts.iter_mut().zip(row.chunks_mut(size)) {
                part.w2.push(piece);
            }
        }
        parts
    }
}

/// The derivatives that belong to some of the hidden units.
pub(super) struct UnitGradients<'a> {
    /// Their rows.
    pub(super) w1: &'a mut [f32],
    pub(super) b1: &'a mut [f32],
    /// Their columns, of each row.
    pub(super) w2: Vec<&'a mut [f32]>,
}
