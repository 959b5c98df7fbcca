//! The batches of a training, each made once.

use crate::StarError;
use crate::model::{WindowBatch, tensor};
use ddl_core::{HORIZON, OBSERVED, Position, WINDOW, Window};
use std::cell::OnceCell;
use std::ops::Range;
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
    /// Least mean number of pedestrians in the parts of a batch; `None` for whole batches.
    part: Option<usize>,
    /// The parts of each batch.
    made: Vec<OnceCell<Vec<TrainingBatch>>>,
}

/// A batch, or a part of it, with its future and the goals of its pedestrians.
#[derive(Debug)]
pub(crate) struct TrainingBatch {
    pub(crate) scenes: WindowBatch,
    /// `[P, 2]`, metres.
    pub(crate) goals: Tensor,
}

impl TrainingBatch {
    /// The batch under the rotation and mirror of a step, with [jitter](Self::jittered) if there is any.
    pub(crate) fn varied(&self, turn: Option<&Tensor>, jitter: f64) -> Self {
        let turned = match turn {
            Some(images) => self.turned(images),
            None => self.shared(),
        };
        if jitter > 0.0 { turned.jittered(jitter) } else { turned }
    }

    /// The batch with all positions transformed by the images of the axes, the rows of `images` `[2, 2]`.
    pub(crate) fn turned(&self, images: &Tensor) -> Self {
        Self { scenes: self.scenes.turned(images), goals: self.goals.matmul(images) }
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
        Self { scenes: WindowBatch { positions, ..scenes }, goals }
    }

    pub(crate) fn shared(&self) -> Self {
        Self { scenes: self.scenes.shared(), goals: self.goals.shallow_clone() }
    }
}

impl PreparedBatches {
    /// Prepares `count` batches of `windows`, each with its future and with its goals unless these are the true
    /// endpoints. The parts of a batch have at least `part` pedestrians on average.
    pub(crate) fn new(
        (windows, goals): (Vec<Window>, Option<Vec<Vec<Position>>>),
        count: usize,
        neighbour_box: f64,
        part: Option<usize>,
        (device, kind): (Device, Kind),
    ) -> Self {
        Self { windows, goals, neighbour_box, device, kind, part, made: (0..count).map(|_| OnceCell::new()).collect() }
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
        let sizes: Vec<usize> = windows.iter().map(|&index| self.windows[index].len()).collect();
        let parts = parts(&sizes, self.part.unwrap_or(usize::MAX)).into_iter();
        let parts = parts.map(|part| self.part_of(&windows[part])).collect::<Result<_, _>>()?;
        Ok(place.get_or_init(|| parts))
    }

    fn part_of(&self, windows: &[usize]) -> Result<TrainingBatch, StarError> {
        let scenes: Vec<&Window> = windows.iter().map(|&index| &self.windows[index]).collect();
        let scenes = WindowBatch::new(&scenes, WINDOW, WINDOW - 1, self.neighbour_box, self.device, self.kind)?;
        let goals = match &self.goals {
            None => scenes.positions.f_get(WINDOW as i64 - 1)?,
            Some(goals) => {
                let goals: Vec<f64> = windows.iter().flat_map(|&index| &goals[index]).flatten().copied().collect();
                tensor(&goals, &[-1, 2], (self.kind, self.device))?
            }
        };
        Ok(TrainingBatch { scenes, goals })
    }
}

/// Divides windows with these numbers of pedestrians into parts with similar numbers, and at least `least` pedestrians
/// on average.
fn parts(sizes: &[usize], least: usize) -> Vec<Range<usize>> {
    let pedestrians: usize = sizes.iter().sum();
    let count = (pedestrians / least).max(1);
    let mut parts = Vec::new();
    let (mut start, mut before, mut reached) = (0, 0, 0);
    for (index, size) in sizes.iter().enumerate() {
        before += size;
        // How many of equal parts end before or with this window.
        let ended = before * count / pedestrians.max(1);
        if ended > reached {
            parts.push(start..index + 1);
            (start, reached) = (index + 1, ended);
        }
    }
    parts
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a test may panic")]

    use super::*;
    use ddl_data::{Dataset, WindowRule};
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn parts_are_consecutive_and_as_equal_as_the_windows_allow(
            sizes in proptest::collection::vec(prop_oneof![9 => 1_usize..40, 1 => 40_usize..2000], 1..80),
            least in 1_usize..400,
        ) {
            let parts = parts(&sizes, least);
            let whole: Vec<usize> = parts.iter().cloned().flatten().collect();
            prop_assert_eq!(whole, (0..sizes.len()).collect::<Vec<_>>());
            let [total, largest] = [sizes.iter().sum::<usize>(), sizes.iter().copied().max().unwrap()];
            let count = (total / least).max(1);
            prop_assert!(parts.len() <= count);
            for part in parts {
                prop_assert!(!part.is_empty());
                let pedestrians: usize = sizes[part].iter().sum();
                prop_assert!(pedestrians <= total / count + largest + 1, "{} of {}", pedestrians, total);
            }
        }
    }

    #[test]
    fn jitter_moves_only_observed_positions() {
        let windows = Dataset::simulated(1).recordings()[0].windows(WindowRule::Complete);
        let (device, kind) = (Device::Cpu, Kind::Double);
        let indices: Vec<usize> = (0..windows.len()).collect();
        let prepared = PreparedBatches::new((windows, None), 1, 10.0, None, (device, kind));
        let [exact] = prepared.batch(0, &indices).unwrap() else { panic!("one part") };
        tch::manual_seed(7);
        let off = exact.shared().jittered(0.05);
        let moved = &off.scenes.positions - &exact.scenes.positions;
        let (observed, future) = (moved.slice(0, 0, 8, 1), moved.slice(0, 8, 20, 1));
        assert_eq!(future, future.zeros_like());
        assert_eq!(off.goals, exact.goals);
        // Every pedestrian, frame and axis has its own error, and those of some pedestrians are small. The mean square
        // of a uniform deviation is a third of the square of the largest.
        let squares = observed.square();
        let overall = squares.mean(Kind::Double).double_value(&[]).sqrt();
        assert!((overall - 0.05 / 3_f64.sqrt()).abs() < 0.004, "{overall}");
        assert!(observed.abs().min().double_value(&[]) > 0.0);
        let deviations = squares.mean_dim([0i64, 2].as_slice(), false, Kind::Double).sqrt();
        let (least, most) = (deviations.min().double_value(&[]), deviations.max().double_value(&[]));
        assert!(least < 0.01 && most > 0.04 && most < 0.1, "{least} to {most}");
    }
}
