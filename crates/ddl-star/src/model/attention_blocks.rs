//! The queries and keys of attention among the pedestrians of several scenes, in blocks.

use ddl_network::backend::Scenes;
use rayon::prelude::*;
use std::collections::BTreeSet;
use std::ops::Range;
use tch::{Device, Kind, Tensor};

/// Most queries in a block. Larger scenes are divided, so that each block reads only the neighbours of its queries: all
/// pairs of a large crowd would not fit into memory.
const QUERIES: usize = 64;

/// The number of keys is a multiple of this: fused attention on CUDA then takes the mask without a copy.
const ALIGNMENT: usize = 8;

/// S blocks of at most L queries and M keys. A query attends to the keys that it sees.
#[derive(Debug)]
pub struct AttentionBlocks {
    blocks: i64,
    /// `[S * L]`, the pedestrian of each query, padded with the first of the block.
    pub(super) queries: Tensor,
    /// `[S * M]`, the pedestrian of each key, padded likewise.
    pub(super) keys: Tensor,
    /// `[P]`, the place of each pedestrian among the queries.
    places: Tensor,
    /// `[F, S, L, M]`: 0 for a key that the query sees, -inf elsewhere. A padded query sees one key, so that its
    /// weights are finite.
    mask: Tensor,
}

/// One block: its queries, and the pedestrians that they see in any frame.
struct AttentionBlock {
    queries: Range<usize>,
    keys: Vec<usize>,
}

impl AttentionBlocks {
    /// The blocks of `scenes` in all their frames.
    pub(crate) fn new(scenes: &Scenes, device: Device, kind: Kind) -> Self {
        let blocks = blocks(scenes);
        let length = blocks.iter().map(|block| block.queries.len()).max().unwrap_or(0);
        let width = blocks.iter().map(|block| block.keys.len()).max().unwrap_or(0).next_multiple_of(ALIGNMENT);
        let (mut queries, mut keys, mut places) = (Vec::new(), Vec::new(), Vec::new());
        for block in &blocks {
            let first = block.queries.start;
            let padded = |of: &mut Vec<i64>, pedestrians: &mut dyn Iterator<Item = usize>, length: usize| {
                let end = of.len() + length;
                of.extend(pedestrians.map(|pedestrian| pedestrian as i64));
                of.resize(end, first as i64);
            };
            places.extend((queries.len() as i64..).take(block.queries.len()));
            padded(&mut queries, &mut block.queries.clone(), length);
            padded(&mut keys, &mut block.keys.iter().copied(), width);
        }
        let seen = seen(scenes, &blocks, [length, width]);
        let shape = [scenes.frames(), blocks.len(), length, width].map(|count| count as i64);
        // Bytes are copied to the device.
        let unseen = Tensor::from_slice(&seen).to_device(device).logical_not().reshape(shape);
        Self {
            blocks: blocks.len() as i64,
            queries: Tensor::from_slice(&queries).to_device(device),
            keys: Tensor::from_slice(&keys).to_device(device),
            places: Tensor::from_slice(&places).to_device(device),
            mask: Tensor::zeros(shape, (kind, device)).masked_fill(&unseen, f64::NEG_INFINITY),
        }
    }

    /// The same blocks in some of the frames.
    pub(crate) fn during(&self, frames: Range<usize>) -> Self {
        Self {
            blocks: self.blocks,
            queries: self.queries.shallow_clone(),
            keys: self.keys.shallow_clone(),
            places: self.places.shallow_clone(),
            mask: self.mask.narrow(0, frames.start as i64, frames.len() as i64),
        }
    }

    /// The inverse of [`in_blocks`](Self::in_blocks) of the queries, which drops the padding.
    pub(super) fn out_of_blocks(&self, x: &Tensor) -> Tensor {
        let (batch, width) = (x.size()[0], x.size()[3]);
        x.reshape([batch, -1, width]).index_select(1, &self.places)
    }

    /// Shapes: `[B * S, 1, L, M]` for one frame, or B.
    pub(super) fn mask(&self, entries: i64) -> Tensor {
        let (length, width) = (self.mask.size()[2], self.mask.size()[3]);
        let mask = self.mask.expand([entries, self.blocks, length, width], false);
        mask.reshape([entries * self.blocks, 1, length, width])
    }

    /// The rows of `pedestrians`, queries or keys. Shapes: `x` `[B, P, n]` -> `[B, S, L, n]` or `[B, S, M, n]`.
    pub(super) fn in_blocks(&self, x: &Tensor, pedestrians: &Tensor) -> Tensor {
        let (batch, width) = (x.size()[0], x.size()[2]);
        x.index_select(1, pedestrians).view([batch, self.blocks, -1, width])
    }
}

fn blocks(scenes: &Scenes) -> Vec<AttentionBlock> {
    let of_scene = |scene: &Range<usize>| {
        let end = scene.end;
        scene.clone().step_by(QUERIES).map(move |start| start..end.min(start + QUERIES))
    };
    let queries: Vec<Range<usize>> = scenes.ranges().iter().flat_map(of_scene).collect();
    let block = |queries: Range<usize>| {
        let frames = 0..scenes.frames();
        let seen = frames.flat_map(|frame| scenes.pairs(frame, queries.clone()));
        let keys: BTreeSet<usize> = seen.map(|(_, key)| key).collect();
        let keys = keys.into_iter().collect();
        AttentionBlock { queries, keys }
    };
    queries.into_par_iter().map(block).collect()
}

/// `[F, S, L, M]`: whether a query sees a key.
fn seen(scenes: &Scenes, blocks: &[AttentionBlock], [length, width]: [usize; 2]) -> Vec<bool> {
    let of_block = length * width;
    let mut seen = vec![false; scenes.frames() * blocks.len() * of_block];
    let parts = seen.par_chunks_mut(of_block).enumerate();
    parts.for_each(|(part, seen)| {
        let (frame, AttentionBlock { queries, keys }) = (part / blocks.len(), &blocks[part % blocks.len()]);
        for padding in queries.len()..length {
            seen[padding * width] = true;
        }
        for (query, key) in scenes.pairs(frame, queries.clone()) {
            let column = keys.partition_point(|&before| before < key);
            seen[(query - queries.start) * width + column] = true;
        }
    });
    seen
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a test may panic")]

    use super::*;
    use crate::model::attention::spatial_attention;
    use ddl_core::{OBSERVED, PedestrianId, Position, Window};
    use proptest::prelude::*;

    /// A crowd of pedestrians that stand at these places.
    fn crowd(places: &[Position]) -> Window {
        let ids = (0..places.len()).map(|i| PedestrianId(i as i64)).collect();
        let tracks = places.iter().map(|&place| vec![place; OBSERVED]).collect();
        Window::new("crowd", 0, 1, ids, tracks).unwrap()
    }

    proptest! {
        /// In scenes of any size, every pedestrian attends to exactly those that it sees.
        #[test]
        fn attention_is_over_the_visible(
            sizes in prop::collection::vec(prop_oneof![1..9_usize, 60..200_usize], 1..4),
            seed in 0..99_i64,
        ) {
            let (cpu, kind) = (Device::Cpu, Kind::Double);
            tch::manual_seed(seed);
            let place = || {
                let xy = Vec::<f64>::try_from(Tensor::rand([2], (kind, cpu)) * 9.0).unwrap();
                [xy[0], xy[1]]
            };
            let windows: Vec<Window> = sizes
                .iter()
                .map(|&size| crowd(&(0..size).map(|_| place()).collect::<Vec<_>>()))
                .collect();
            let windows: Vec<&Window> = windows.iter().collect();
            let scenes = ddl_network::visibility(&windows, OBSERVED, 2.0);
            let pedestrians = scenes.pedestrians() as i64;
            let frames = 2..4;
            let (heads, width) = (2, 4);
            let qkv = Tensor::randn([2, pedestrians, 3 * width], (kind, cpu));
            let blocks = AttentionBlocks::new(&scenes, cpu, kind);
            let ours = spatial_attention(&qkv, heads, &blocks.during(frames.clone()), 0.0);
            // All pairs, with the same definition of attention.
            let all = |part: i64| {
                qkv.narrow(2, part * width, width).view([2, -1, heads, width / heads]).transpose(1, 2)
            };
            let [query, key, value] = [0, 1, 2].map(all);
            let unseen = Tensor::ones([2, 1, pedestrians, pedestrians], (Kind::Bool, cpu));
            for (entry, frame) in frames.enumerate() {
                for (query, key) in scenes.pairs(frame, 0..scenes.pedestrians()) {
                    let _ = unseen.get(entry as i64).get(0).get(query as i64).get(key as i64).fill_(0.0);
                }
            }
            let scores = query.matmul(&key.transpose(2, 3)) / f64::from((width / heads) as i32).sqrt();
            let weights = scores.masked_fill(&unseen, f64::NEG_INFINITY).softmax(-1, kind);
            let expected = weights.matmul(&value).transpose(1, 2).reshape([2, pedestrians, width]);
            let difference = (ours - expected).abs().max().double_value(&[]);
            prop_assert!(difference < 1e-12, "{difference}");
        }
    }
}
