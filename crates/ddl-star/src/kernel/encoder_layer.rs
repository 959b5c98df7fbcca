//! A whole Transformer encoder layer (Vaswani et al. 2017, section 3.1), normalised after each residual connection.

mod backward;
mod forward;
mod keep;
#[cfg(test)]
mod tests;
mod weights;

use super::add_norm::AddNorm;
use super::affine::Affine;
use super::among_walkers::{AmongWalkers, Attended};
use super::buffer::Buffer;
use super::dropout::Dropout;
use super::feed_forward::FeedForward;
use super::instruction_set::Dispatch;
#[cfg(test)]
use super::instruction_set::InstructionSet;
use super::over_memory::{KeyValue, OverMemory, OverMemoryGradients};
use super::scenes::Frames;
use crate::Precision;
use backward::Parts;
use forward::Targets;
use keep::Attention;
pub(crate) use keep::{Kept, Remembered};
pub(crate) use weights::Sizes;

/// z = norm(x + d(W mixed + b)), y = norm(z + d(f(z))): `mixed` by attention from queries, keys and values, which are
/// affine in x, f the feed-forward block.
///
/// # Numerics
/// Results and gradients do not depend on the number of threads, results neither on the other rows that are computed
/// along (attention among walkers aside). The instruction sets agree to rounding.
#[derive(Clone, Debug)]
pub(crate) struct EncoderLayer {
    sizes: Sizes,
    /// To queries, keys and values.
    projections: [Affine; 3],
    out: Affine,
    norm1: AddNorm,
    norm2: AddNorm,
    feed_forward: FeedForward,
    among: AmongWalkers,
    over: OverMemory,
    dispatch: Dispatch,
}

/// The four dropouts of a layer, each with a seed of its own.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Dropouts {
    /// Of attention weights.
    pub(crate) weights: Option<Dropout>,
    /// Of what attention adds to its input.
    pub(crate) attended: Option<Dropout>,
    /// Of hidden activations.
    pub(crate) hidden: Option<Dropout>,
    /// Of what the feed-forward block adds to its input.
    pub(crate) fed: Option<Dropout>,
}

impl EncoderLayer {
    /// A layer whose learned numbers are all 0.
    ///
    /// # Panics
    /// When a size is 0, or the heads are more than 256 or do not divide the width.
    pub(crate) fn zeros(sizes: Sizes) -> Self {
        let Sizes {
            width,
            heads,
            hidden,
        } = sizes;
        assert!(
            heads > 0 && width.is_multiple_of(heads),
            "{heads} heads of a width of {width}"
        );
        Self {
            sizes,
            projections: [0; 3].map(|_| Affine::new(width, width)),
            out: Affine::new(width, width),
            norm1: AddNorm::new(width),
            norm2: AddNorm::new(width),
            feed_forward: FeedForward::zeros(width, hidden),
            among: AmongWalkers::new(heads, width / heads),
            over: OverMemory::new(heads, width / heads),
            dispatch: Dispatch::detect(),
        }
    }

    /// The same with chosen instructions; `None` when the machine lacks them.
    #[cfg(test)]
    pub(super) fn with_instructions(self, set: InstructionSet) -> Option<Self> {
        Some(Self {
            feed_forward: self.feed_forward.with_instructions(set)?,
            among: self.among.with_instructions(set)?,
            over: self.over.with_instructions(set)?,
            dispatch: Dispatch::new(set)?,
            ..self
        })
    }

    /// Takes over learned numbers, in the order of [`Sizes`], for a feed-forward block in that precision. There is no backward
    /// pass in bf16.
    ///
    /// # Panics
    /// When there are more or fewer than [`Sizes::count`].
    pub(crate) fn update(&mut self, weights: &[f32], precision: Precision) {
        let width = self.sizes.width;
        let [w, b, wo, bo, w1, b1, w2, b2, n1, c1, n2, c2] = self.sizes.pieces(weights);
        let parts = w.chunks_exact(width * width).zip(b.chunks_exact(width));
        for (projection, (w, b)) in self.projections.iter_mut().zip(parts) {
            projection.update(w, b);
        }
        self.out.update(wo, bo);
        self.norm1.update(n1, c1);
        self.norm2.update(n2, c2);
        self.feed_forward.update([w1, b1, w2, b2], precision);
    }

    /// The layer with attention among the walkers of each scene.
    ///
    /// # Shapes
    /// `x` `[B, P, width]`; `frames` one or B -> y `[B, P, width]`.
    ///
    /// # Panics
    /// When a shape does not fit.
    pub(crate) fn among_walkers(
        &self,
        x: &[f32],
        frames: Frames<'_>,
        dropouts: Dropouts,
    ) -> (Buffer, Kept) {
        let mut qkv = Buffer::any(3 * x.len());
        self.project(0, x, Targets::Together(&mut qkv));
        let mut attended = Attended::default();
        self.among
            .forward(&qkv, frames, dropouts.weights, &mut attended);
        let attention = Attention::Among { qkv, attended };
        self.after_attention(x, attention, dropouts)
    }

    /// The gradients of [`among_walkers`](Self::among_walkers).
    ///
    /// # Shapes
    /// `gy` like `x` -> the gradient of x; those of the learned numbers are added to `of_weights`, [`Sizes::count`].
    ///
    /// # Panics
    /// When a shape does not fit. The other arguments must be those of the forward pass.
    pub(crate) fn among_walkers_backward(
        &self,
        x: &[f32],
        frames: Frames<'_>,
        dropouts: Dropouts,
        kept: &Kept,
        gy: &[f32],
        of_weights: &mut [f32],
    ) -> Buffer {
        let Attention::Among { qkv, attended } = &kept.attention else {
            panic!("what was kept is of attention over memory");
        };
        let (mut gx, of_mixed) = self.before_attention(kept, dropouts, gy, of_weights);
        let mut of_qkv = Buffer::any(qkv.len());
        self.among.backward(
            qkv,
            frames,
            dropouts.weights,
            attended,
            &of_mixed,
            &mut of_qkv,
        );
        let parts = Parts::Together(&of_qkv);
        self.project_backward(0, x, &parts, &mut gx, of_weights);
        gx
    }

    /// The layer with attention of the newest token over remembered ones and itself.
    ///
    /// # Shapes
    /// `x` `[rows, width]`; `memory` of as many rows each, or a divisor, as [`OverMemory::forward`] has it
    /// -> y `[rows, width]`.
    ///
    /// # Panics
    /// When a shape does not fit.
    pub(crate) fn over_memory(
        &self,
        x: &[f32],
        memory: &[&Remembered],
        dropouts: Dropouts,
    ) -> (Buffer, Kept) {
        let [mut query, mut key, mut value] = [0; 3].map(|_| Buffer::any(x.len()));
        self.project(0, x, Targets::Apart(vec![&mut query, &mut key, &mut value]));
        let own = Remembered { key, value };
        let mut mixed = Buffer::any(x.len());
        self.over
            .forward(&query, &views(memory), own.view(), &mut mixed);
        let attention = Attention::Over { query, own, mixed };
        self.after_attention(x, attention, dropouts)
    }

    /// The gradients of [`over_memory`](Self::over_memory).
    ///
    /// # Shapes
    /// `gy` like `x` -> the gradient of x; those of the memory are added to `of_memory`, which has as many rows each as
    /// `x`, as `memory` must have here; those of the learned numbers to `of_weights`, [`Sizes::count`].
    ///
    /// # Panics
    /// When a shape does not fit. The other arguments must be those of the forward pass.
    #[expect(
        clippy::too_many_arguments,
        reason = "all of the forward pass, and its gradients"
    )]
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
        let Attention::Over { query, own, .. } = &kept.attention else {
            panic!("what was kept is of attention among walkers");
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
    ///
    /// # Shapes
    /// `x` `[rows, width]`.
    ///
    /// # Panics
    /// When a shape does not fit.
    pub(crate) fn remember(&self, x: &[f32]) -> Remembered {
        let [mut key, mut value] = [0; 2].map(|_| Buffer::any(x.len()));
        self.project(1, x, Targets::Apart(vec![&mut key, &mut value]));
        Remembered { key, value }
    }

    /// The gradients of [`remember`](Self::remember): that of x; those of the learned numbers are added to `of_weights`.
    ///
    /// # Panics
    /// When a shape does not fit.
    pub(crate) fn remember_backward(
        &self,
        x: &[f32],
        gradient: &Remembered,
        of_weights: &mut [f32],
    ) -> Buffer {
        let mut gx = Buffer::zeros(x.len());
        let parts = Parts::Apart(vec![&gradient.key, &gradient.value]);
        self.project_backward(1, x, &parts, &mut gx, of_weights);
        gx
    }
}

fn views<'a>(memory: &[&'a Remembered]) -> Vec<KeyValue<'a>> {
    memory.iter().map(|token| token.view()).collect()
}
