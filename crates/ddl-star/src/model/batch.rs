//! Several windows concatenated into tensors.

use crate::StarError;
use crate::model::attention_blocks::AttentionBlocks;
use crate::model::numbers::tensor;
use crate::model::scene_rows::TensorSceneRows;
use ddl_core::Window;
use ddl_network::backend::Scenes;
use ddl_network::{NetworkError, visibility};
use std::ops::Range;
use std::rc::Rc;
use std::sync::{Arc, Mutex, PoisonError};
use tch::{Device, Kind, Tensor};

/// The pedestrians of several windows, concatenated, with their neighbours.
///
/// # Shapes
/// T frames, P pedestrians in total: positions `[T, P, 2]` in metres; neighbours in the first M frames.
#[derive(Debug)]
pub(crate) struct WindowBatch {
    pub(crate) positions: Tensor,
    /// The neighbours in each frame.
    pub(crate) scenes: Arc<Scenes>,
    pub(crate) rows: TensorSceneRows,
    /// The neighbours in all frames for libtorch, made at the first use.
    pub(crate) seen: Arc<Mutex<Option<AttentionBlocks>>>,
    /// Share of the network's metric in the metric of a step, `[1]` or `[1, P, 1]`.
    pub(crate) share: Tensor,
}

impl WindowBatch {
    /// Concatenates windows: `frames` of each, with the neighbours of the first `mask_frames`.
    ///
    /// # Errors
    /// [`NetworkError::Shape`] when there is no window, or one is shorter than `frames`.
    pub(crate) fn new(
        windows: &[&Window],
        frames: usize,
        mask_frames: usize,
        neighbour_box: f64,
        device: Device,
        kind: Kind,
    ) -> Result<Self, StarError> {
        let pedestrians: usize = windows.iter().map(|window| window.len()).sum();
        if pedestrians == 0 {
            let got = format!("{} windows", windows.len());
            let expected = "at least one window with a pedestrian";
            return Err(NetworkError::shape("scene batch", expected, got).into());
        }
        let mut positions = vec![0.0; frames * pedestrians * 2];
        let mut first = 0;
        for window in windows {
            check_length(window, frames)?;
            for i in 0..window.len() {
                for (t, [x, y]) in window.track(i).iter().take(frames).enumerate() {
                    let first_number = 2 * (t * pedestrians + first + i);
                    positions[first_number] = *x;
                    positions[first_number + 1] = *y;
                }
            }
            first += window.len();
        }
        let (t, p) = (frames as i64, pedestrians as i64);
        let scenes = visibility(windows, mask_frames, neighbour_box);
        Ok(Self {
            positions: tensor(&positions, &[t, p, 2], (kind, device))?,
            rows: TensorSceneRows::new(scenes.ranges(), device, kind),
            scenes: Arc::new(scenes),
            seen: Arc::default(),
            share: Tensor::ones([1], (kind, device)),
        })
    }

    /// All positions transformed by the images of the axes, the rows of `images` `[2, 2]`. Neighbours are kept.
    pub(crate) fn turned(&self, images: &Tensor) -> Self {
        Self { positions: self.positions.matmul(images), ..self.shared() }
    }

    /// The same batch, without copying.
    pub(crate) fn shared(&self) -> Self {
        Self {
            positions: self.positions.shallow_clone(),
            scenes: Arc::clone(&self.scenes),
            rows: self.rows.shallow_clone(),
            seen: Arc::clone(&self.seen),
            share: self.share.shallow_clone(),
        }
    }

    /// The neighbours for libtorch during `frames`: one frame serves every batch entry, several serve one entry each.
    pub(crate) fn seen(&self, frames: Range<usize>) -> Rc<AttentionBlocks> {
        let mut seen = self.seen.lock().unwrap_or_else(PoisonError::into_inner);
        let seen = seen.get_or_insert_with(|| {
            let (device, kind) = (self.positions.device(), self.positions.kind());
            AttentionBlocks::new(&self.scenes, device, kind)
        });
        Rc::new(seen.during(frames))
    }

    /// The number of pedestrians in all windows.
    pub(crate) fn pedestrians(&self) -> usize {
        self.positions.size()[1] as usize
    }
}

fn check_length(window: &Window, frames: usize) -> Result<(), StarError> {
    let got = window.track(0).len();
    if got >= frames {
        return Ok(());
    }
    Err(NetworkError::shape(
        "scene batch",
        format!("{frames} frames in every window"),
        format!("{got} in {}@{}", window.recording(), window.start_frame()),
    )
    .into())
}
