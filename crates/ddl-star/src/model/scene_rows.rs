//! Scenes in rows of the length of the largest one: means over scenes, and attention among their pedestrians.

use crate::model::crowd::NeighbourLists;
use ddl_network::backend::Scenes;
use std::ops::Range;
use tch::{Device, Kind, Tensor};

/// The length of rows is a multiple of this: fused attention on CUDA then takes the mask without a copy.
const ALIGNMENT: usize = 8;

/// The rows of S scenes, each padded to a common length L.
#[derive(Debug)]
pub struct SceneRows {
    scenes: i64,
    length: i64,
    /// `[S * L]`, the pedestrians of each scene, padded with its first pedestrian.
    pedestrians: Tensor,
    /// `[P]`, the place of each pedestrian.
    places: Tensor,
    /// `[S, L, 1]`, 1 / size for the pedestrians of a scene, 0 for padding.
    shares: Tensor,
}

impl SceneRows {
    pub(crate) fn new(scenes: &[Range<usize>], device: Device, kind: Kind) -> Self {
        let length = scenes.iter().map(Range::len).max().unwrap_or(0);
        let length = length.next_multiple_of(ALIGNMENT);
        let (mut pedestrians, mut shares, mut places) = (Vec::new(), Vec::new(), Vec::new());
        for scene in scenes {
            let padding = length - scene.len();
            places.extend((pedestrians.len() as i64..).take(scene.len()));
            pedestrians.extend(scene.clone().map(|pedestrian| pedestrian as i64));
            pedestrians.extend(std::iter::repeat_n(scene.start as i64, padding));
            shares.extend(std::iter::repeat_n(1.0 / scene.len() as f64, scene.len()));
            shares.extend(std::iter::repeat_n(0.0, padding));
        }
        let (scenes, length) = (scenes.len() as i64, length as i64);
        Self {
            scenes,
            length,
            pedestrians: Tensor::from_slice(&pedestrians).to_device(device),
            places: Tensor::from_slice(&places).to_device(device),
            shares: Tensor::from_slice(&shares)
                .reshape([scenes, length, 1])
                .to_kind(kind)
                .to_device(device),
        }
    }

    /// Shapes: `x` `[B, P, n]` -> `[B, S, L, n]`.
    pub(crate) fn in_rows(&self, x: &Tensor) -> Tensor {
        let (batch, width) = (x.size()[0], x.size()[2]);
        let rows = x.index_select(1, &self.pedestrians);
        rows.view([batch, self.scenes, self.length, width])
    }

    /// The inverse of [`in_rows`](Self::in_rows), which drops the padding.
    pub(crate) fn out_of_rows(&self, rows: &Tensor) -> Tensor {
        let (batch, width) = (rows.size()[0], rows.size()[3]);
        rows.reshape([batch, -1, width]).index_select(1, &self.places)
    }

    /// For every pedestrian, the mean of `x` over its scene, summed in a fixed order: CUDA's sums by index have none.
    /// Shapes: `x` `[B, P, n]` -> the same.
    pub(crate) fn means(&self, x: &Tensor) -> Tensor {
        let rows = self.in_rows(x);
        let means = (&rows * &self.shares).sum_dim_intlist([2i64].as_slice(), true, None::<Kind>);
        self.out_of_rows(&means.expand_as(&rows))
    }

    /// `[frames, S, L, L]`: 0 for a pedestrian itself and those that it sees, -inf elsewhere. Padding sees itself, so
    /// that its weights are finite.
    pub(crate) fn mask(&self, scenes: &Scenes) -> Tensor {
        let (rows, length) = (self.scenes as usize, self.length as usize);
        let of_frame = rows * length * length;
        let mut mask = vec![f32::NEG_INFINITY; scenes.frames() * of_frame];
        for (frame, mask) in mask.chunks_exact_mut(of_frame).enumerate() {
            for (place, row) in mask.chunks_exact_mut(length).enumerate() {
                row[place % length] = 0.0;
            }
            let mut seen = scenes.pairs(frame).peekable();
            for (scene, mask) in scenes.ranges().iter().zip(mask.chunks_exact_mut(length * length)) {
                while let Some((query, key)) = seen.next_if(|(query, _)| scene.contains(query)) {
                    mask[(query - scene.start) * length + key - scene.start] = 0.0;
                }
            }
        }
        let shape = [scenes.frames() as i64, self.scenes, self.length, self.length];
        Tensor::from_slice(&mask)
            .to_kind(self.shares.kind())
            .reshape(shape)
            .to_device(self.shares.device())
    }

    pub(crate) fn shallow_clone(&self) -> Self {
        Self {
            pedestrians: self.pedestrians.shallow_clone(),
            places: self.places.shallow_clone(),
            shares: self.shares.shallow_clone(),
            ..*self
        }
    }
}

/// Which pedestrians see each other during one frame for all batch entries, or one frame for each.
#[derive(Debug)]
pub enum SeenNeighbours {
    /// Attention within rows.
    Rows {
        /// Rows of scenes.
        rows: SceneRows,
        /// `[1 or B, S, L, L]`: see [`SceneRows::mask`].
        mask: Tensor,
    },
    /// Attention over lists, in large scenes.
    Lists(NeighbourLists),
}

/// Scenes with more pedestrians than this have lists of neighbours: the mask of a frame would have millions of pairs.
const LARGEST_ROW: i64 = 512;

impl SeenNeighbours {
    /// The neighbours in all frames of `scenes`, in `rows` if these are short.
    pub(crate) fn new(rows: &SceneRows, scenes: &Scenes) -> Self {
        if rows.length > LARGEST_ROW {
            return Self::Lists(NeighbourLists::new(scenes, rows.shares.device(), rows.shares.kind()));
        }
        Self::Rows {
            rows: rows.shallow_clone(),
            mask: rows.mask(scenes),
        }
    }

    pub(crate) fn during(&self, frames: Range<usize>) -> Self {
        match self {
            Self::Rows { rows, mask } => Self::Rows {
                rows: rows.shallow_clone(),
                mask: mask.narrow(0, frames.start as i64, frames.len() as i64),
            },
            Self::Lists(lists) => Self::Lists(lists.during(frames)),
        }
    }
}
