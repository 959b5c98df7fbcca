//! Multi-head attention (Vaswani et al. 2017, section 3.2) of projected tokens, in the two forms that STAR needs.

use crate::model::attention_blocks::AttentionBlocks;
use tch::Tensor;

/// Attention of every pedestrian over its neighbours. Shapes: `qkv` `[B, P, 3 * width]`; `seen` during one time step or
/// B -> `[B, P, width]`.
pub(super) fn spatial_attention(qkv: &Tensor, heads: i64, seen: &AttentionBlocks, dropout: f64) -> Tensor {
    let (entries, width) = (qkv.size()[0], qkv.size()[2] / 3);
    let queries = seen.in_blocks(&qkv.narrow(2, 0, width), &seen.queries);
    let (blocks, length) = (queries.size()[1], queries.size()[2]);
    let count = entries * blocks;
    let query = queries.view([count, length, heads, width / heads]).transpose(1, 2);
    let pairs = seen.in_blocks(&qkv.narrow(2, width, 2 * width), &seen.keys);
    let parts = pairs.view([count, -1, 2, heads, width / heads]).unbind(2);
    let [key, value] = [0, 1].map(|part: usize| parts[part].transpose(1, 2));
    let (mask, scale) = (seen.mask(entries), scale(width, heads));
    let mixed = Tensor::scaled_dot_product_attention(&query, &key, &value, Some(&mask), dropout, false, scale, false);
    let mixed = mixed.transpose(1, 2).reshape([entries, blocks, length, width]);
    seen.out_of_blocks(&mixed)
}

/// Attention of the newest token over all tokens so far. Shapes: `tokens` `[t, B, P, 3 * width]`, the newest last ->
/// `[B, P, width]`.
pub(super) fn temporal_attention(tokens: &Tensor, heads: i64) -> Tensor {
    let (batch, pedestrians, width) = (tokens.size()[1], tokens.size()[2], tokens.size()[3] / 3);
    let parts = tokens.view([-1, batch, pedestrians, 3, heads, width / heads]).unbind(3);
    let (query, key, value) = (parts[0].narrow(0, -1, 1), &parts[1], &parts[2]);
    // With one query for each pedestrian and head, products and sums are faster than a batch of 1 x t matrix products,
    // and fused attention takes 145 us backwards on a card.
    let scores = key * (query * scale(width, heads));
    let scores = scores.sum_dim_intlist([-1i64].as_slice(), true, None);
    let weights = scores.softmax(0, scores.kind());
    (value * weights).sum_dim_intlist([0i64].as_slice(), false, None).reshape([batch, pedestrians, width])
}

fn scale(width: i64, heads: i64) -> f64 {
    1.0 / ((width / heads) as f64).sqrt()
}
