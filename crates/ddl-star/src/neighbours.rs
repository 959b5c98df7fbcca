//! Who sees whom in a batch of scenes.

use std::cell::OnceCell;
use std::ops::Range;
use std::rc::Rc;

use tch::{Device, Kind, Tensor};

use crate::kernel::{Frames, Scenes};

/// Who sees whom in each frame of a batch: scene by scene for the kernels, as one mask for libtorch.
#[derive(Debug)]
pub(crate) struct Neighbours {
    scenes: Rc<Scenes>,
    /// For each frame, for each scene, `[size, size]`.
    visible: Rc<[bool]>,
    device: Device,
    kind: Kind,
    dense: OnceCell<Tensor>,
}

impl Neighbours {
    /// # Shapes
    /// `sizes`: walkers of each scene; `visible`: for each frame, for each scene, `[size, size]`.
    pub(crate) fn new(sizes: &[usize], visible: &[bool], device: Device, kind: Kind) -> Self {
        Self {
            scenes: Rc::new(Scenes::new(sizes, visible)),
            visible: Rc::from(visible),
            device,
            kind,
            dense: OnceCell::new(),
        }
    }

    /// Who sees whom during some frames: one frame serves every batch entry, several one entry each.
    pub(crate) fn during(&self, frames: Range<usize>) -> Seen<'_> {
        Seen {
            neighbours: self,
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

    /// The same neighbours for other positions of the same walkers.
    pub(crate) fn shared(&self) -> Self {
        Self {
            scenes: Rc::clone(&self.scenes),
            visible: Rc::clone(&self.visible),
            device: self.device,
            kind: self.kind,
            dense: match self.dense.get() {
                Some(dense) => OnceCell::from(dense.shallow_clone()),
                None => OnceCell::new(),
            },
        }
    }
}

/// [`Neighbours`] during some frames.
#[derive(Debug, Clone)]
pub(crate) struct Seen<'a> {
    neighbours: &'a Neighbours,
    frames: Range<usize>,
}

impl Seen<'_> {
    /// The mask for libtorch, `[frames, 1, P, P]`.
    pub(crate) fn mask(&self) -> Tensor {
        let (first, count) = (self.frames.start as i64, self.frames.len() as i64);
        self.neighbours.dense().narrow(0, first, count)
    }

    /// For the kernels, to be kept until the gradient is asked for.
    pub(crate) fn scenes(&self) -> SeenScenes {
        SeenScenes {
            scenes: Rc::clone(&self.neighbours.scenes),
            frames: self.frames.clone(),
        }
    }
}

/// Scenes during some frames, owned.
#[derive(Debug, Clone)]
pub(crate) struct SeenScenes {
    scenes: Rc<Scenes>,
    frames: Range<usize>,
}

impl SeenScenes {
    pub(crate) fn frames(&self) -> Frames<'_> {
        self.scenes.during(self.frames.clone())
    }
}
