//! Multi-head attention (Vaswani et al. 2017, section 3.2), in the two forms STAR needs:
//! every pedestrian over its neighbours, and the newest token over all earlier ones.

use super::backend::TorchBackend;
use super::neighbours::Seen;
use ddl_network::backend::Mode;
use ddl_network::weights::EncoderLayer;
use std::rc::Rc;
use tch::Tensor;

/// The attention of an encoder layer, with one joint projection for query, key and value.
#[derive(Debug)]
pub(super) struct Attention<'a> {
    backend: &'a TorchBackend,
    /// Numbers of the weights of the joint projection, and of the map afterwards.
    projection: usize,
    out: usize,
    heads: i64,
    width: i64,
    dropout: f64,
}

impl<'a> Attention<'a> {
    pub(super) fn new(backend: &'a TorchBackend, layer: EncoderLayer) -> Self {
        let sizes = layer.sizes();
        Self {
            backend,
            projection: layer.tensor(),
            out: layer.tensor() + 2,
            heads: sizes.heads as i64,
            width: sizes.width as i64,
            dropout: layer.dropout(),
        }
    }

    /// Attention of every pedestrian over those that it sees.
    ///
    /// # Shapes
    /// `x` `[B, P, width]`; `seen` during one time step or B -> `[B, P, width]`.
    pub(super) fn among_pedestrians(&self, x: &Tensor, seen: &Seen) -> Tensor {
        let qkv = self.backend.affine(x, self.projection);
        // Row by row: see `Packing`.
        let entries = qkv.size()[0];
        let rows = seen.in_rows(&qkv);
        let (count, length) = (rows.size()[0], rows.size()[1]);
        let parts = rows
            .view([count, length, 3, self.heads, self.width / self.heads])
            .unbind(2);
        let [query, key, value] = [0, 1, 2].map(|part: usize| parts[part].transpose(1, 2));
        let dropout = match self.backend.mode() {
            Mode::Train => self.dropout,
            Mode::Evaluate => 0.0,
        };
        let mixed = Tensor::scaled_dot_product_attention(
            &query,
            &key,
            &value,
            Some(&seen.row_mask(entries)),
            dropout,
            false,
            self.scale(),
            false,
        );
        let mixed = mixed.transpose(1, 2).reshape([count, length, self.width]);
        self.backend.affine(&seen.out_of_rows(&mixed), self.out)
    }

    /// Attention of the newest token over itself and the cached ones.
    ///
    /// # Shapes
    /// `newest` `[B, P, width]`; `cache` as [`key_values`](Self::key_values) gives it -> `[B, P, width]`.
    pub(super) fn over_cache(&self, newest: &Tensor, cache: &[Rc<Tensor>]) -> Tensor {
        let (batch, pedestrians) = (newest.size()[0], newest.size()[1]);
        let qkv = self.backend.affine(newest, self.projection);
        let cached = cache.iter().map(|token| &**token);
        let tokens: Vec<&Tensor> = cached.chain([&qkv]).collect();
        // All projections of all tokens at once: one copy, and one gradient for each token.
        let parts = Tensor::stack(&tokens, 0)
            .view([
                -1,
                batch,
                pedestrians,
                3,
                self.heads,
                self.width / self.heads,
            ])
            .unbind(3);
        let (query, key, value) = (parts[0].narrow(0, -1, 1), &parts[1], &parts[2]);
        // One query a pedestrian and head: products and sums beat a batch of 1 x t matrix products.
        let scores = (key * (query * self.scale())).sum_dim_intlist([-1i64].as_slice(), true, None);
        let weights = scores.softmax(0, scores.kind());
        let mixed = (value * weights)
            .sum_dim_intlist([0i64].as_slice(), false, None)
            .reshape([batch, pedestrians, self.width]);
        self.backend.affine(&mixed, self.out)
    }

    /// Query, key and value of tokens side by side, to be cached, `[B, P, 3 * width]`; the query is not used.
    ///
    /// # Shapes
    /// `token` `[B, P, width]`.
    pub(super) fn key_values(&self, token: &Tensor) -> Tensor {
        // The query is projected too: a part of the weights would have a gradient as large as the whole, at every token.
        self.backend.affine(token, self.projection)
    }

    fn scale(&self) -> f64 {
        1.0 / ((self.width / self.heads) as f64).sqrt()
    }
}

#[cfg(test)]
#[path = "attention_tests.rs"]
mod tests;
