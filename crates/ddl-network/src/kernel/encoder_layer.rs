//! A Transformer encoder layer (Vaswani et al. 2017, section 3.1) with normalisation after each residual connection.

mod backward;
mod forward;
mod forward_results;
mod layer;
#[cfg(test)]
mod tests;

use crate::kernel::buffer::Buffer;
use crate::kernel::scenes::SceneFrames;
use crate::kernel::spatial_attention::Attended;
use crate::kernel::temporal_attention::KeyValue;
use forward_results::AttentionResults;
pub(crate) use forward_results::{CachedKeyValues, ForwardResults};
pub use layer::Sizes;
pub(crate) use layer::{Dropouts, EncoderKernel};

impl EncoderKernel {
    /// The layer with spatial attention.
    /// `x` `[B, P, width]`; 1 or B `frames` -> y `[B, P, width]`. Without `keep`, the results
    /// serve no backward pass.
    pub(crate) fn spatial_attention(
        &self,
        x: &[f32],
        frames: SceneFrames<'_>,
        dropouts: Dropouts,
        keep: bool,
    ) -> (Buffer, ForwardResults) {
        let [query, key, value] = self.project(0, x);
        let inputs = [&query[..], &key, &value];
        let attended = self.attention.spatial_forward(inputs, frames, dropouts.weights, keep);
        let newest = CachedKeyValues { key, value };
        let attention = AttentionResults { query, newest, attended };
        self.after_attention(x, attention, dropouts, keep)
    }

    /// The gradients of [`spatial_attention`](Self::spatial_attention).
    /// `gy` like `x` -> the gradient of x. The gradients of the weights are added to `of_weights`, `[Sizes::count]`.
    /// The other arguments must be those of the forward pass.
    pub(crate) fn spatial_attention_backward(
        &self,
        x: &[f32],
        frames: SceneFrames<'_>,
        dropouts: Dropouts,
        forward_results: &ForwardResults,
        gy: &[f32],
        of_weights: &mut [f32],
    ) -> Buffer {
        let kept = &forward_results.attention;
        let (mut gx, of_mixed) = self.before_attention(forward_results, dropouts, gy, of_weights);
        let inputs = [&kept.query[..], &kept.newest.key, &kept.newest.value];
        let mut of_inputs = [0; 3].map(|_| Buffer::any(x.len()));
        let gradients = of_inputs.each_mut().map(|gradient| &mut gradient[..]);
        self.attention.spatial_backward(inputs, frames, dropouts.weights, &kept.attended, &of_mixed, gradients);
        let of_inputs = of_inputs.each_ref().map(|gradient| &gradient[..]);
        self.project_backward(0, x, of_inputs, &mut gx, of_weights);
        gx
    }

    /// The layer with temporal attention: the newest token attends to the cached tokens and to itself.
    /// `x` `[rows, width]`; tokens in `cache` have as many rows, or a divisor, as for
    /// `AttentionKernel::temporal_forward` -> y `[rows, width]`. Without `keep`, the results serve no backward pass.
    pub(crate) fn temporal_attention(
        &self,
        x: &[f32],
        cache: &[&CachedKeyValues],
        dropouts: Dropouts,
        keep: bool,
    ) -> (Buffer, ForwardResults) {
        let [query, key, value] = self.project(0, x);
        let newest = CachedKeyValues { key, value };
        let mut mixed = Buffer::any(x.len());
        self.attention.temporal_forward(&query, &views(cache), newest.view(), &mut mixed);
        let attention = AttentionResults { query, newest, attended: Attended { mixed, normalisers: Vec::new() } };
        self.after_attention(x, attention, dropouts, keep)
    }

    /// The gradients of [`temporal_attention`](Self::temporal_attention). `gy` like `x` -> the gradient of x. Those of
    /// the cache are added to `of_cache`, those of the weights to `of_weights`, `[Sizes::count]`. The tokens of `cache`
    /// and `of_cache` must have as many rows as `x`. The other arguments must be those of the forward pass.
    #[expect(clippy::too_many_arguments, reason = "all of the forward pass, and its gradients")]
    pub(crate) fn temporal_attention_backward(
        &self,
        x: &[f32],
        cache: &[&CachedKeyValues],
        dropouts: Dropouts,
        forward_results: &ForwardResults,
        gy: &[f32],
        of_cache: &mut [&mut CachedKeyValues],
        of_weights: &mut [f32],
    ) -> Buffer {
        let AttentionResults { query, newest, .. } = &forward_results.attention;
        let (mut gx, of_mixed) = self.before_attention(forward_results, dropouts, gy, of_weights);
        let mut of_query = Buffer::zeros(x.len());
        let mut of_newest = CachedKeyValues::zeros(x.len());
        let of_tokens = of_cache.iter_mut().map(|token| token.view_mut()).chain([of_newest.view_mut()]).collect();
        self.attention.temporal_backward(query, &views(cache), newest.view(), &of_mixed, &mut of_query, of_tokens);
        let of_inputs = [&of_query[..], &of_newest.key, &of_newest.value];
        self.project_backward(0, x, of_inputs, &mut gx, of_weights);
        gx
    }

    /// Keys and values of tokens, for later queries.
    /// `x` `[rows, width]`.
    pub(crate) fn key_values(&self, x: &[f32]) -> CachedKeyValues {
        let [key, value] = self.project(1, x);
        CachedKeyValues { key, value }
    }

    /// The gradient of x through [`key_values`](Self::key_values). Those of the weights are added to `of_weights`.
    pub(crate) fn key_values_backward(&self, x: &[f32], gradient: &CachedKeyValues, of_weights: &mut [f32]) -> Buffer {
        let mut gx = Buffer::zeros(x.len());
        self.project_backward(1, x, [&gradient.key[..], &gradient.value], &mut gx, of_weights);
        gx
    }
}

fn views<'a>(cache: &[&'a CachedKeyValues]) -> Vec<KeyValue<&'a [f32]>> {
    cache.iter().map(|token| token.view()).collect()
}
