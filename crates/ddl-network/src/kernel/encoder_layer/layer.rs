//! The weights of a layer: their order, and the layout for its passes.

use crate::kernel::add_norm::AddNorm;
use crate::kernel::affine::Affine;
use crate::kernel::dropout::Dropout;
use crate::kernel::feed_forward::FeedForward;
use crate::kernel::heads::{AttentionKernel, HEAD_WIDTH};
use ddl_simd::Dispatch;

/// z = norm(x + d(W mixed + b)), y = norm(z + d(f(z))). `mixed` is the output of attention, whose queries, keys and
/// values are affine in x; f is the feed-forward block; d is dropout.
///
/// Results and gradients do not depend on the number of threads. Apart from spatial attention, the result of a row does
/// not depend on the other rows. Results of different instruction sets agree up to rounding.
#[derive(Clone, Debug)]
pub(crate) struct EncoderKernel {
    pub(super) sizes: Sizes,
    pub(super) projections: [Affine; 3],
    pub(super) out: Affine,
    pub(super) norm1: AddNorm,
    pub(super) norm2: AddNorm,
    pub(super) feed_forward: FeedForward,
    pub(super) attention: AttentionKernel,
    pub(super) dispatch: Dispatch,
}

#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Dropouts {
    pub(crate) weights: Option<Dropout>,
    pub(crate) attended: Option<Dropout>,
    pub(crate) hidden: Option<Dropout>,
    pub(crate) fed: Option<Dropout>,
}

impl EncoderKernel {
    pub(crate) fn zeros(sizes: Sizes) -> Self {
        let Sizes { width, heads, hidden } = sizes;
        assert!(width == heads * HEAD_WIDTH, "{heads} heads of a width of {width}");
        Self {
            sizes,
            projections: [0; 3].map(|_| Affine::new(width, width)),
            out: Affine::new(width, width),
            norm1: AddNorm::new(width),
            norm2: AddNorm::new(width),
            feed_forward: FeedForward::zeros(width, hidden),
            attention: AttentionKernel::new(heads),
            dispatch: Dispatch::detect(),
        }
    }

    /// Replaces the weights, in the order of [`Sizes`].
    pub(crate) fn update(&mut self, weights: &[f32]) {
        let width = self.sizes.width;
        let [w, b, wo, bo, w1, b1, w2, b2, n1, c1, n2, c2] = self.sizes.pieces(weights);
        let parts = w.chunks_exact(width * width).zip(b.chunks_exact(width));
        for (projection, (w, b)) in self.projections.iter_mut().zip(parts) {
            projection.update(w, b);
        }
        self.out.update(wo, bo);
        self.norm1.update(n1, c1);
        self.norm2.update(n2, c2);
        self.feed_forward.update([w1, b1, w2, b2]);
    }
}

/// Sizes of an encoder layer.
///
/// The weights of a layer, in this order, with row-major matrices:
/// - weight `[3 width, width]` and bias of queries, keys and values,
/// - weight `[width, width]` and bias of the map after attention,
/// - weight `[hidden, width]` and bias of the feed-forward block before `ReLU`,
/// - weight `[width, hidden]` and bias after it,
/// - weight and bias of the first normalisation, and of the second.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sizes {
    /// Width of a token.
    pub width: usize,
    /// Attention heads, a quarter of the width.
    pub heads: usize,
    /// Hidden units of the feed-forward block.
    pub hidden: usize,
}

const PIECES: usize = 12;

impl Sizes {
    /// Number of weights.
    pub(crate) fn count(self) -> usize {
        self.lengths().iter().sum()
    }

    fn lengths(self) -> [usize; PIECES] {
        let Self { width, hidden, .. } = self;
        [
            3 * width * width,
            3 * width,
            width * width,
            width,
            hidden * width,
            hidden,
            width * hidden,
            width,
            width,
            width,
            width,
            width,
        ]
    }

    pub(super) fn pieces(self, mut numbers: &[f32]) -> [&[f32]; PIECES] {
        self.check(numbers);
        self.lengths().map(|length| numbers.split_off(..length).unwrap_or_default())
    }

    pub(super) fn pieces_mut(self, mut numbers: &mut [f32]) -> [&mut [f32]; PIECES] {
        self.check(numbers);
        self.lengths().map(|length| numbers.split_off_mut(..length).unwrap_or_default())
    }

    fn check(self, numbers: &[f32]) {
        assert_eq!(numbers.len(), self.count(), "learned numbers of an encoder layer");
    }
}
