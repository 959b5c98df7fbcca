//! The mean over the pedestrians of each scene.

use std::ops::Range;
use tch::{Device, Kind, Tensor};

/// Means over scenes, summed in a fixed order. CUDA's sums by index have no fixed order.
#[derive(Debug)]
pub(crate) struct SceneMeans {
    scenes: i64,
    largest: i64,
    /// `[S * largest]`, the pedestrians of each scene, padded with its first pedestrian.
    pedestrians: Tensor,
    /// `[S, largest, 1]`, 1 / size for the pedestrians of a scene, 0 for padding.
    shares: Tensor,
    /// `[P]`, the scene of each pedestrian.
    scene_of: Tensor,
}

impl SceneMeans {
    pub(crate) fn new(scenes: &[Range<usize>], device: Device, kind: Kind) -> Self {
        let largest = scenes.iter().map(Range::len).max().unwrap_or(0);
        let places = scenes.len() * largest;
        let (mut pedestrians, mut shares) = (Vec::with_capacity(places), Vec::with_capacity(places));
        let mut scene_of = Vec::new();
        for (index, scene) in scenes.iter().enumerate() {
            for place in 0..largest {
                let real = place < scene.len();
                pedestrians.push((scene.start + if real { place } else { 0 }) as i64);
                shares.push(if real { 1.0 / scene.len() as f64 } else { 0.0 });
            }
            scene_of.extend(std::iter::repeat_n(index as i64, scene.len()));
        }
        let (scenes, largest) = (scenes.len() as i64, largest as i64);
        Self {
            scenes,
            largest,
            pedestrians: Tensor::from_slice(&pedestrians).to_device(device),
            shares: Tensor::from_slice(&shares)
                .reshape([scenes, largest, 1])
                .to_kind(kind)
                .to_device(device),
            scene_of: Tensor::from_slice(&scene_of).to_device(device),
        }
    }

    /// For every pedestrian, the mean of `x` over its scene. Shapes: `x` `[B, P, n]` -> the same.
    pub(crate) fn of(&self, x: &Tensor) -> Tensor {
        let (batch, width) = (x.size()[0], x.size()[2]);
        let side_by_side = x
            .index_select(1, &self.pedestrians)
            .view([batch, self.scenes, self.largest, width]);
        (side_by_side * &self.shares)
            .sum_dim_intlist([2i64].as_slice(), false, None::<Kind>)
            .index_select(1, &self.scene_of)
    }

    pub(crate) fn shallow_clone(&self) -> Self {
        Self {
            pedestrians: self.pedestrians.shallow_clone(),
            shares: self.shares.shallow_clone(),
            scene_of: self.scene_of.shallow_clone(),
            ..*self
        }
    }
}
