//! The views of many pedestrians as tensors.

use crate::StarError;
use crate::model::tensor;
use ddl_core::{OBSERVED, WINDOW};
use ddl_network::{PedestrianView, ProposalConfig};
use tch::{Device, Kind, Tensor};

/// Views as tensors.
/// Shapes: `own` `[.., T, 2]`, `neighbours` `[.., J, T, 2]`, `present` `[.., J]` (1 or 0), with T = 8.
#[derive(Debug)]
pub(crate) struct Views {
    pub(crate) own: Tensor,
    pub(crate) neighbours: Tensor,
    pub(crate) present: Tensor,
    pub(crate) remembered: RememberedViews,
}

/// Earlier pedestrians of the place, G in each view; G is 0 for a network without a memory branch. Shapes: `tracks`
/// `[.., G, 20, 2]`, `distances` `[.., G]`, `present` `[.., G]` (1 or 0).
#[derive(Debug)]
pub(crate) struct RememberedViews {
    pub(crate) tracks: Tensor,
    pub(crate) distances: Tensor,
    pub(crate) present: Tensor,
}

impl RememberedViews {
    fn new<'a>(
        views: impl Iterator<Item = &'a PedestrianView>,
        count: i64,
        config: &ProposalConfig,
        options: (Kind, Device),
    ) -> Result<Self, StarError> {
        let slots = config.memory.as_ref().map_or(0, |memory| memory.remembered);
        let (mut tracks, mut distances, mut present) = (Vec::new(), Vec::new(), Vec::new());
        for view in views {
            let taken = view.remembered.len().min(slots);
            for other in &view.remembered[..taken] {
                tracks.extend_from_slice(other.track.as_flattened());
                distances.push(other.distance);
                present.push(1.0);
            }
            let empty = slots - taken;
            tracks.resize(tracks.len() + empty * WINDOW * 2, 0.0);
            distances.resize(distances.len() + empty, 0.0);
            present.resize(present.len() + empty, 0.0);
        }
        let (slots, steps) = (slots as i64, WINDOW as i64);
        Ok(Self {
            tracks: tensor(&tracks, &[count, slots, steps, 2], options)?,
            distances: tensor(&distances, &[count, slots], options)?,
            present: tensor(&present, &[count, slots], options)?,
        })
    }
}

impl Views {
    pub(crate) fn new<'a>(
        views: impl ExactSizeIterator<Item = &'a PedestrianView> + Clone,
        config: &ProposalConfig,
        device: Device,
        kind: Kind,
    ) -> Result<Self, StarError> {
        let (count, slots) = (views.len() as i64, config.neighbours);
        let track = (OBSERVED * 2) as i64;
        let remembered = RememberedViews::new(views.clone(), count, config, (kind, device))?;
        let (mut own_tracks, mut neighbours, mut present) = (Vec::new(), Vec::new(), Vec::new());
        for view in views {
            own_tracks.extend_from_slice(view.own.as_flattened());
            let taken = view.neighbours.len().min(slots);
            for neighbour in &view.neighbours[..taken] {
                neighbours.extend_from_slice(neighbour.as_flattened());
            }
            neighbours.resize(neighbours.len() + (slots - taken) * OBSERVED * 2, 0.0);
            present.extend((0..slots).map(|slot| f64::from(u8::from(slot < taken))));
        }
        let tensor = |values: &[f64], shape: &[i64]| tensor(values, shape, (kind, device));
        let slots = slots as i64;
        Ok(Self {
            own: tensor(&own_tracks, &[count, track / 2, 2])?,
            neighbours: tensor(&neighbours, &[count, slots, track / 2, 2])?,
            present: tensor(&present, &[count, slots])?,
            remembered,
        })
    }

    /// The views of the given rows, in the shape of `rows`.
    /// Shapes: `rows` `[M, B]` -> tensors `[M, B, ..]`.
    pub(crate) fn rows(&self, rows: &Tensor) -> Self {
        self.map(|tensor| rows_of(tensor, rows))
    }

    /// The same pedestrians for each of `members` members: `[B, ..]` -> `[M, B, ..]`, without a copy.
    pub(crate) fn for_each_of(&self, members: i64) -> Self {
        self.map(|tensor| {
            let mut shape = tensor.size();
            shape.insert(0, members);
            tensor.unsqueeze(0).expand(shape.as_slice(), false)
        })
    }

    fn map(&self, change: impl Fn(&Tensor) -> Tensor) -> Self {
        Self {
            own: change(&self.own),
            neighbours: change(&self.neighbours),
            present: change(&self.present),
            remembered: RememberedViews {
                tracks: change(&self.remembered.tracks),
                distances: change(&self.remembered.distances),
                present: change(&self.remembered.present),
            },
        }
    }
}

/// Rows of `tensor` `[N, ..]` by `rows` `[M, B]` -> `[M, B, ..]`.
pub(crate) fn rows_of(tensor: &Tensor, rows: &Tensor) -> Tensor {
    let mut shape = rows.size();
    shape.extend_from_slice(&tensor.size()[1..]);
    tensor.index_select(0, &rows.reshape([-1])).reshape(shape.as_slice())
}
