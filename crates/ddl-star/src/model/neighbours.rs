//! Neighbours in a batch of scenes.

use std::ops::Range;
use std::sync::{Arc, Mutex, PoisonError};

use tch::{Device, Kind, Tensor};

use crate::model::packing::Packing;
use ddl_network::backend::Scenes;

/// The neighbours in each frame of a batch: by scene for the kernels, in rows for libtorch.
#[derive(Debug)]
pub(crate) struct Neighbours {
    scenes: Arc<Scenes>,
    device: Device,
    kind: Kind,
    rows: Mutex<Option<MaskedRows>>,
}

impl Neighbours {
    pub(crate) fn new(scenes: Scenes, device: Device, kind: Kind) -> Self {
        Self {
            scenes: Arc::new(scenes),
            device,
            kind,
            rows: Mutex::new(None),
        }
    }

    pub(crate) fn scenes(&self) -> &Arc<Scenes> {
        &self.scenes
    }

    /// The neighbours during some frames: one frame serves every batch entry, several serve one entry each.
    pub(crate) fn during(self: &Arc<Self>, frames: Range<usize>) -> SeenNeighbours {
        SeenNeighbours {
            neighbours: Arc::clone(self),
            frames,
        }
    }

    fn with_rows<T>(&self, read: impl FnOnce(&MaskedRows) -> T) -> T {
        let mut rows = self.rows.lock().unwrap_or_else(PoisonError::into_inner);
        read(rows.get_or_insert_with(|| {
            let scenes = &self.scenes;
            let packing = Packing::new(scenes.ranges());
            let (rows, length) = (packing.rows(), packing.length());
            let frames = scenes.frames();
            let mut mask = vec![f32::NEG_INFINITY; frames * rows * length * length];
            let masks = mask.chunks_exact_mut(rows * length * length);
            for (frame, mask) in masks.enumerate() {
                // Padding entries attend to themselves, so that their weights are finite.
                for (place, row) in mask.chunks_exact_mut(length).enumerate() {
                    row[place % length] = 0.0;
                }
                for (pedestrian, seen) in scenes.pairs(frame) {
                    let [pedestrian, seen] = [pedestrian, seen].map(|pedestrian| packing.places()[pedestrian]);
                    mask[pedestrian * length + seen % length] = 0.0;
                }
            }
            let shape = [frames, rows, length, length].map(|size| size as i64);
            let indices = |numbers: &[usize]| {
                let numbers: Vec<i64> = numbers.iter().map(|&number| number as i64).collect();
                Tensor::from_slice(&numbers).to_device(self.device)
            };
            MaskedRows {
                pedestrians: indices(&packing.pedestrians()),
                places: indices(packing.places()),
                mask: Tensor::from_slice(&mask)
                    .to_kind(self.kind)
                    .reshape(shape)
                    .to_device(self.device),
            }
        }))
    }
}

#[derive(Debug)]
struct MaskedRows {
    /// The pedestrian at each place of the rows, `[R * L]`.
    pedestrians: Tensor,
    /// The place of each pedestrian, `[P]`.
    places: Tensor,
    /// `[frames, R, L, L]`: 0 for a pedestrian itself and its neighbours, -inf elsewhere.
    mask: Tensor,
}

/// [`Neighbours`] during some frames.
#[derive(Debug, Clone)]
pub struct SeenNeighbours {
    neighbours: Arc<Neighbours>,
    frames: Range<usize>,
}

impl SeenNeighbours {
    /// Pedestrians in rows of equal length, for libtorch. Shapes: `x` `[B, P, n]` -> `[B * R, L, n]`.
    pub(crate) fn in_rows(&self, x: &Tensor) -> Tensor {
        self.neighbours.with_rows(|rows| {
            let length = rows.mask.size()[3];
            x.index_select(1, &rows.pedestrians).view([-1, length, x.size()[2]])
        })
    }

    /// The inverse of [`in_rows`](Self::in_rows). Shapes: `x` `[B * R, L, n]` -> `[B, P, n]`.
    pub(crate) fn out_of_rows(&self, x: &Tensor) -> Tensor {
        self.neighbours.with_rows(|rows| {
            let (places, width) = (rows.pedestrians.size()[0], x.size()[2]);
            x.reshape([-1, places, width]).index_select(1, &rows.places)
        })
    }

    /// The mask of the rows of a batch of `entries`: `[B * R, 1, L, L]`, 0 or -inf. Neighbours are of the same scene,
    /// and every row of the mask has at least one 0.
    pub(crate) fn row_mask(&self, entries: i64) -> Tensor {
        let mask = self.neighbours.with_rows(|rows| rows.mask.shallow_clone());
        let (rows, length) = (mask.size()[1], mask.size()[3]);
        mask.narrow(0, self.frames.start as i64, self.frames.len() as i64)
            .expand([entries, rows, length, length], false)
            .reshape([entries * rows, 1, length, length])
    }
}
