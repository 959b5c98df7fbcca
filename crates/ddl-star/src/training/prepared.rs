//! The batches of a training, each made once.

use crate::StarError;
use crate::model::{SceneBatch, tensor};
use ddl_data::{HORIZON, OBSERVED, Position, WINDOW, Window};
use std::cell::OnceCell;
use tch::{Device, Kind, Tensor};

/// Training windows as batches on the device of the network, each made at its first visit.
#[derive(Debug)]
pub(crate) struct PreparedBatches {
    windows: Vec<Window>,
    /// One goal for each pedestrian of each window; `None` for the true endpoints.
    goals: Option<Vec<Vec<Position>>>,
    neighbour_box: f64,
    device: Device,
    kind: Kind,
    /// Pedestrians of a part, about; `None` for whole batches.
    part: Option<usize>,
    /// The parts of each batch.
    made: Vec<OnceCell<Vec<TrainingBatch>>>,
}

/// A batch, or a part of it, with its future and the goals of its pedestrians.
#[derive(Debug)]
pub(crate) struct TrainingBatch {
    pub(crate) scenes: SceneBatch,
    /// `[P, 2]`, metres.
    pub(crate) goals: Tensor,
}

impl TrainingBatch {
    /// The batch with all positions transformed by the images of the axes, the rows of `images` `[2, 2]`.
    pub(crate) fn turned(&self, images: &Tensor) -> Self {
        Self {
            scenes: self.scenes.turned(images),
            goals: self.goals.matmul(images),
        }
    }

    /// Adds a normal error to every observed coordinate, with a standard deviation for each pedestrian that is uniform
    /// from 0 to `jitter` (m). Future and goals are unchanged. Draws from libtorch's generator.
    pub(crate) fn jittered(self, jitter: f64) -> Self {
        let Self { scenes, goals } = self;
        let observed = scenes.positions.narrow(0, 0, OBSERVED as i64);
        let future = scenes.positions.narrow(0, OBSERVED as i64, HORIZON as i64);
        let options = (observed.kind(), observed.device());
        let deviations = Tensor::rand([1, observed.size()[1], 1], options) * jitter;
        let observed = &observed + observed.randn_like() * deviations;
        let positions = Tensor::cat(&[observed, future], 0);
        Self {
            scenes: SceneBatch { positions, ..scenes },
            goals,
        }
    }

    pub(crate) fn shared(&self) -> Self {
        Self {
            scenes: self.scenes.shared(),
            goals: self.goals.shallow_clone(),
        }
    }
}

impl PreparedBatches {
    /// Prepares `count` batches of `windows`, each with its future and with its goals unless these are the true
    /// endpoints. Batches are in parts of about `part` pedestrians.
    pub(crate) fn new(
        (windows, goals): (Vec<Window>, Option<Vec<Vec<Position>>>),
        count: usize,
        neighbour_box: f64,
        part: Option<usize>,
        (device, kind): (Device, Kind),
    ) -> Self {
        Self {
            windows,
            goals,
            neighbour_box,
            device,
            kind,
            part,
            made: (0..count).map(|_| OnceCell::new()).collect(),
        }
    }

    pub(crate) fn window(&self, index: usize) -> &Window {
        &self.windows[index]
    }

    /// The parts of the batch of that index, which consists of `windows`, the same at every call. Shapes: all 20
    /// frames, with neighbours of the first 19.
    pub(crate) fn batch(&self, index: usize, windows: &[usize]) -> Result<&[TrainingBatch], StarError> {
        let place = &self.made[index];
        if let Some(parts) = place.get() {
            return Ok(parts);
        }
        let parts = self.parts(windows).map(|part| self.made_of(part));
        let parts = parts.collect::<Result<_, _>>()?;
        Ok(place.get_or_init(|| parts))
    }

    /// Windows one after the other, with about the same number of pedestrians in each part.
    fn parts<'a>(&self, windows: &'a [usize]) -> impl Iterator<Item = &'a [usize]> {
        let pedestrians = |windows: &[usize]| -> usize {
            let each = windows.iter().map(|&index| self.windows[index].len());
            each.sum()
        };
        let all = pedestrians(windows);
        let count = self.part.map_or(1, |part| (all / part).max(1));
        let mut ends: Vec<usize> = (1..count)
            .map(|part| {
                let before = |&end: &usize| pedestrians(&windows[..end]) * count < all * part;
                (0..windows.len()).take_while(before).count()
            })
            .collect();
        ends.push(windows.len());
        ends.dedup();
        let starts = std::iter::once(0).chain(ends.clone());
        starts.zip(ends).map(|(start, end)| &windows[start..end])
    }

    fn made_of(&self, windows: &[usize]) -> Result<TrainingBatch, StarError> {
        let scenes: Vec<&Window> = windows.iter().map(|&index| &self.windows[index]).collect();
        let scenes = SceneBatch::new(&scenes, WINDOW, WINDOW - 1, self.neighbour_box, self.device, self.kind)?;
        let goals = match &self.goals {
            None => scenes.positions.f_get(WINDOW as i64 - 1)?,
            Some(goals) => {
                let goals = windows.iter().flat_map(|&index| &goals[index]);
                let goals: Vec<f64> = goals.flatten().copied().collect();
                tensor(&goals, &[-1, 2], (self.kind, self.device))?
            }
        };
        Ok(TrainingBatch { scenes, goals })
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a test may panic")]

    use super::*;
    use ddl_data::{Dataset, WindowRule};

    #[test]
    fn jitter_moves_only_observed_positions() {
        let dataset = Dataset::simulated(1);
        let windows = dataset.recordings()[0].windows(WindowRule::Complete);
        let (device, kind) = (Device::Cpu, Kind::Double);
        let all: Vec<usize> = (0..windows.len()).collect();
        let prepared = PreparedBatches::new((windows, None), 1, 10.0, None, (device, kind));
        let [exact] = prepared.batch(0, &all).unwrap() else {
            panic!("one part")
        };
        tch::manual_seed(7);
        let off = exact.shared().jittered(0.05);
        let moved = off.scenes.positions() - exact.scenes.positions();
        let (observed, future) = (moved.slice(0, 0, 8, 1), moved.slice(0, 8, 20, 1));
        assert_eq!(future, future.zeros_like());
        assert_eq!(off.goals, exact.goals);
        // Every pedestrian, frame and axis has its own error, and those of some pedestrians are small. The mean square
        // of a uniform deviation is a third of the square of the largest.
        let squares = observed.square();
        let all = squares.mean(Kind::Double).double_value(&[]).sqrt();
        assert!((all - 0.05 / 3_f64.sqrt()).abs() < 0.004, "{all}");
        assert!(observed.abs().min().double_value(&[]) > 0.0);
        let each = squares.mean_dim([0i64, 2].as_slice(), false, Kind::Double).sqrt();
        let (least, most) = (each.min().double_value(&[]), each.max().double_value(&[]));
        assert!(least < 0.01 && most > 0.04 && most < 0.1, "{least} to {most}");
    }
}
