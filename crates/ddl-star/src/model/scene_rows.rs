//! Means over scenes, which lie in rows of the length of the largest one.

use std::ops::Range;
use tch::{Device, Kind, Tensor};

/// The rows of S scenes, each padded to the length L of the largest one.
#[derive(Debug)]
pub(crate) struct TensorSceneRows {
    scenes: i64,
    length: i64,
    /// `[S * L]`, the pedestrians of each scene, padded with its first pedestrian.
    pedestrians: Tensor,
    /// `[P]`, the place of each pedestrian.
    places: Tensor,
    /// `[S, L, 1]`, 1 / size for the pedestrians of a scene, 0 for padding.
    shares: Tensor,
}

impl TensorSceneRows {
    pub(crate) fn new(scenes: &[Range<usize>], device: Device, kind: Kind) -> Self {
        let length = scenes.iter().map(Range::len).max().unwrap_or(0);
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
            shares: Tensor::from_slice(&shares).reshape([scenes, length, 1]).to_kind(kind).to_device(device),
        }
    }

    /// For every pedestrian, the mean of `x` over its scene, summed in a fixed order: CUDA's sums by index have none.
    /// Shapes: `x` `[B, P, n]` -> the same.
    pub(crate) fn means(&self, x: &Tensor) -> Tensor {
        let (batch, width) = (x.size()[0], x.size()[2]);
        let rows = x.index_select(1, &self.pedestrians).view([batch, self.scenes, self.length, width]);
        let means = (&rows * &self.shares).sum_dim_intlist([2i64].as_slice(), true, None::<Kind>);
        means.expand_as(&rows).reshape([batch, -1, width]).index_select(1, &self.places)
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
