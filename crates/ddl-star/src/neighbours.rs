//! Who sees whom in a batch of scenes.

use std::cell::OnceCell;
use std::ops::Range;
use std::rc::Rc;

use tch::{Device, Kind, Tensor};

use crate::kernel::{Frames, Scenes};

/// Who sees whom in each frame of a batch: scene by scene for the kernels, as one mask for libtorch.
#[derive(Debug)]
pub(crate) struct Neighbours {
    scenes: Scenes,
    /// For each frame, for each scene, `[size, size]`.
    visible: Vec<bool>,
    device: Device,
    kind: Kind,
    dense: OnceCell<Tensor>,
}

impl Neighbours {
    /// # Shapes
    /// `sizes`: walkers of each scene; `visible`: for each frame, for each scene, `[size, size]`.
    pub(crate) fn new(sizes: &[usize], visible: Vec<bool>, device: Device, kind: Kind) -> Self {
        Self {
            scenes: Scenes::new(sizes, &visible),
            visible,
            device,
            kind,
            dense: OnceCell::new(),
        }
    }

    /// Who sees whom during some frames: one frame serves every batch entry, several one entry each.
    pub(crate) fn during(self: &Rc<Self>, frames: Range<usize>) -> Seen {
        Seen {
            neighbours: Rc::clone(self),
            frames,
        }
    }

    /// `[frames, 1, P, P]`, 0 where a walker sees another or itself, -inf elsewhere; made when first asked for.
    fn dense(&self) -> &Tensor {
        self.dense.get_or_init(|| {
            let scenes = &self.scenes;
            let (frames, walkers) = (scenes.frames(), scenes.walkers());
            let mut mask = vec![f32::NEG_INFINITY; frames * walkers * walkers];
            let mut visible = self.visible.iter();
            for mask in mask.chunks_exact_mut(walkers * walkers) {
                for scene in scenes.ranges() {
                    for i in scene.clone() {
                        let row = &mut mask[i * walkers..][scene.clone()];
                        for (entry, &seen) in row.iter_mut().zip(visible.by_ref()) {
                            if seen {
                                *entry = 0.0;
                            }
                        }
                    }
                }
            }
            let (frames, walkers) = (frames as i64, walkers as i64);
            Tensor::from_slice(&mask)
                .to_kind(self.kind)
                .reshape([frames, 1, walkers, walkers])
                .to_device(self.device)
        })
    }
}

/// [`Neighbours`] during some frames.
#[derive(Debug, Clone)]
pub(crate) struct Seen {
    neighbours: Rc<Neighbours>,
    frames: Range<usize>,
}

impl Seen {
    /// The mask for libtorch, `[frames, 1, P, P]`.
    pub(crate) fn mask(&self) -> Tensor {
        let (first, count) = (self.frames.start as i64, self.frames.len() as i64);
        self.neighbours.dense().narrow(0, first, count)
    }

    /// The scenes, for the kernels.
    pub(crate) fn frames(&self) -> Frames<'_> {
        self.neighbours.scenes.during(self.frames.clone())
    }
}
