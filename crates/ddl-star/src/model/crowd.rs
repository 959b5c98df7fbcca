//! Attention in a large scene over lists of visible neighbours: a mask of all pairs would not fit into memory.

use ddl_network::backend::Scenes;
use std::ops::Range;
use tch::{Device, Kind, Tensor};

/// The visible pedestrians of each pedestrian, itself included, in lists padded to the longest.
#[derive(Debug)]
pub struct NeighbourLists {
    /// `[F, P * K]`, indices of pedestrians.
    keys: Tensor,
    /// `[F, P, K, 1, 1]`: 0 for a neighbour, -inf for padding.
    mask: Tensor,
}

impl NeighbourLists {
    pub(crate) fn new(scenes: &Scenes, device: Device, kind: Kind) -> Self {
        let pedestrians = scenes.pedestrians();
        let mut lists = vec![Vec::new(); scenes.frames() * pedestrians];
        for frame in 0..scenes.frames() {
            for (query, key) in scenes.pairs(frame) {
                lists[frame * pedestrians + query].push(key as i64);
            }
        }
        let length = lists.iter().map(Vec::len).max().unwrap_or(0);
        let mut keys = vec![0; lists.len() * length];
        let mut mask = vec![f32::NEG_INFINITY; keys.len()];
        for ((list, keys), mask) in lists.iter().zip(keys.chunks_mut(length)).zip(mask.chunks_mut(length)) {
            keys[..list.len()].copy_from_slice(list);
            mask[..list.len()].fill(0.0);
        }
        let (frames, pedestrians, length) = (scenes.frames() as i64, pedestrians as i64, length as i64);
        Self {
            keys: Tensor::from_slice(&keys).to_device(device).reshape([frames, -1]),
            mask: Tensor::from_slice(&mask).to_kind(kind).to_device(device).reshape([
                frames,
                pedestrians,
                length,
                1,
                1,
            ]),
        }
    }

    pub(crate) fn during(&self, frames: Range<usize>) -> Self {
        let [keys, mask] = [&self.keys, &self.mask].map(|x| x.narrow(0, frames.start as i64, frames.len() as i64));
        Self { keys, mask }
    }

    /// Attention of every pedestrian over its neighbours, one batch entry after the other to save memory. Shapes: `qkv`
    /// `[B, P, 3 * width]`, lists of one frame or B -> `[B, P, width]`.
    pub(super) fn attention(&self, qkv: &Tensor, heads: i64, scale: f64) -> Tensor {
        let width = qkv.size()[2] / 3;
        let frames = self.keys.size()[0];
        let (pedestrians, length) = (self.mask.size()[1], self.mask.size()[2]);
        let of_entry = |entry: i64| {
            let frame = if frames == 1 { 0 } else { entry };
            let parts = qkv.get(entry).view([pedestrians, 3, heads, width / heads]).unbind(1);
            let keys = self.keys.get(frame);
            let near = |part: &Tensor| {
                let listed = part.index_select(0, &keys);
                listed.view([pedestrians, length, heads, width / heads])
            };
            let query = (&parts[0] * scale).unsqueeze(1);
            let scores = (near(&parts[1]) * query).sum_dim_intlist([-1i64].as_slice(), true, None);
            let weights = (scores + self.mask.get(frame)).softmax(1, None);
            let mixed = (near(&parts[2]) * weights).sum_dim_intlist([1i64].as_slice(), false, None);
            mixed.view([pedestrians, width])
        };
        Tensor::stack(&(0..qkv.size()[0]).map(of_entry).collect::<Vec<_>>(), 0)
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a test may panic")]

    use super::*;
    use crate::model::attention::spatial_attention;
    use crate::model::scene_rows::{SceneRows, SeenNeighbours};
    use ddl_data::{Dataset, OBSERVED, Window, WindowRule};

    #[test]
    fn lists_and_rows_give_the_same_attention() {
        let windows = Dataset::simulated(1).recordings()[0].windows(WindowRule::Complete);
        let windows: Vec<&Window> = windows.iter().step_by(9).take(5).collect();
        let scenes = ddl_network::visibility(&windows, OBSERVED, 2.0);
        let (cpu, kind, frames) = (Device::Cpu, Kind::Double, OBSERVED as i64);
        tch::manual_seed(1);
        let qkv = Tensor::randn([frames, scenes.pedestrians() as i64, 3 * 8], (kind, cpu));
        let rows = SeenNeighbours::new(&SceneRows::new(scenes.ranges(), cpu, kind), &scenes);
        let lists = SeenNeighbours::Lists(NeighbourLists::new(&scenes, cpu, kind));
        let frame = 2..3;
        for (in_rows, in_lists) in [(rows.during(frame.clone()), lists.during(frame)), (rows, lists)] {
            let [in_rows, in_lists] = [in_rows, in_lists].map(|seen| spatial_attention(&qkv, 2, &seen, 0.0));
            let difference = (in_rows - in_lists).abs().max().double_value(&[]);
            assert!(difference < 1e-12, "{difference}");
        }
    }
}
