//! A Transformer encoder layer (Vaswani et al. 2017, section 3.1) with normalisation after each residual connection.

mod backward;
mod forward;
mod keep;
mod layer;
#[cfg(test)]
mod tests;

use super::buffer::Buffer;
use super::over_memory::{KeyValue, OverMemoryGradients};
use super::scenes::Frames;
use backward::Parts;
use forward::Targets;
use keep::KeptAttention;
pub(crate) use keep::{Kept, Remembered};
pub use layer::Sizes;
pub(crate) use layer::{Dropouts, EncoderKernel};

impl EncoderKernel {
    /// The layer with spatial attention.
    /// `x` `[B, P, width]`; 1 or B `frames` -> y `[B, P, width]`. Without `keep`, what is kept serves no
    /// backward pass.
    pub(crate) fn among_pedestrians(
        &self,
        x: &[f32],
        frames: Frames<'_>,
        dropouts: Dropouts,
        keep: bool,
    ) -> (Buffer, Kept) {
        let mut qkv = Buffer::any(3 * x.len());
        self.project(0, x, Targets::Together(&mut qkv));
        let attended = self.among.forward(&qkv, frames, dropouts.weights, keep);
        let attention = KeptAttention::Among { qkv, attended };
        self.after_attention(x, attention, dropouts, keep)
    }

    /// The gradients of [`among_pedestrians`](Self::among_pedestrians).
    /// `gy` like `x` -> the gradient of x. The gradients of the weights are added to `of_weights`, `[Sizes::count]`.
    /// The other arguments must be those of the forward pass.
    pub(crate) fn among_pedestrians_backward(
        &self,
        x: &[f32],
        frames: Frames<'_>,
        dropouts: Dropouts,
        kept: &Kept,
        gy: &[f32],
        of_weights: &mut [f32],
    ) -> Buffer {
        let KeptAttention::Among { qkv, attended } = &kept.attention else {
            panic!("what was kept is of attention over memory");
        };
        let (mut gx, of_mixed) = self.before_attention(kept, dropouts, gy, of_weights);
        let mut of_qkv = Buffer::any(qkv.len());
        self.among
            .backward(qkv, frames, dropouts.weights, attended, &of_mixed, &mut of_qkv);
        let parts = Parts::Together(&of_qkv);
        self.project_backward(0, x, &parts, &mut gx, of_weights);
        gx
    }

    /// The layer with temporal attention: the newest token attends to the cached tokens and to itself.
    /// `x` `[rows, width]`; tokens in `memory` have as many rows, or a divisor, as in [`OverMemory::forward`]
    /// -> y `[rows, width]`. Without `keep`, what is kept serves no backward pass.
    pub(crate) fn over_memory(
        &self,
        x: &[f32],
        memory: &[&Remembered],
        dropouts: Dropouts,
        keep: bool,
    ) -> (Buffer, Kept) {
        let [mut query, mut key, mut value] = [0; 3].map(|_| Buffer::any(x.len()));
        self.project(0, x, Targets::Apart(vec![&mut query, &mut key, &mut value]));
        let own = Remembered { key, value };
        let mut mixed = Buffer::any(x.len());
        self.over.forward(&query, &views(memory), own.view(), &mut mixed);
        let attention = KeptAttention::Over { query, own, mixed };
        self.after_attention(x, attention, dropouts, keep)
    }

    /// The gradients of [`over_memory`](Self::over_memory). `gy` like `x` -> the gradient of x. The gradients of the
    /// memory are added to `of_memory`, those of the weights to `of_weights`, `[Sizes::count]`. The tokens of `memory`
    /// and `of_memory` must have as many rows as `x`. The other arguments must be those of the forward pass.
    #[expect(clippy::too_many_arguments, reason = "all of the forward pass, and its gradients")]
    pub(crate) fn over_memory_backward(
        &self,
        x: &[f32],
        memory: &[&Remembered],
        dropouts: Dropouts,
        kept: &Kept,
        gy: &[f32],
        of_memory: &mut [&mut Remembered],
        of_weights: &mut [f32],
    ) -> Buffer {
        let KeptAttention::Over { query, own, .. } = &kept.attention else {
            panic!("what was kept is of attention among pedestrians");
        };
        let (mut gx, of_mixed) = self.before_attention(kept, dropouts, gy, of_weights);
        let mut of_query = Buffer::zeros(x.len());
        let mut of_own = Remembered::zeros(x.len());
        let mut of_memory: Vec<_> = of_memory.iter_mut().map(|token| token.view_mut()).collect();
        let gradients = OverMemoryGradients {
            query: &mut of_query,
            memory: &mut of_memory,
            own: of_own.view_mut(),
        };
        self.over
            .backward(query, &views(memory), own.view(), &of_mixed, gradients);
        let parts = Parts::Apart(vec![&of_query, &of_own.key, &of_own.value]);
        self.project_backward(0, x, &parts, &mut gx, of_weights);
        gx
    }

    /// Keys and values of tokens, for later queries.
    /// `x` `[rows, width]`.
    pub(crate) fn remember(&self, x: &[f32]) -> Remembered {
        let [mut key, mut value] = [0; 2].map(|_| Buffer::any(x.len()));
        self.project(1, x, Targets::Apart(vec![&mut key, &mut value]));
        Remembered { key, value }
    }

    /// The gradient of x through [`remember`](Self::remember). The gradients of the weights are added to `of_weights`.
    pub(crate) fn remember_backward(&self, x: &[f32], gradient: &Remembered, of_weights: &mut [f32]) -> Buffer {
        let mut gx = Buffer::zeros(x.len());
        let parts = Parts::Apart(vec![&gradient.key, &gradient.value]);
        self.project_backward(1, x, &parts, &mut gx, of_weights);
        gx
    }
}

fn views<'a>(memory: &[&'a Remembered]) -> Vec<KeyValue<'a>> {
    memory.iter().map(|token| token.view()).collect()
}
