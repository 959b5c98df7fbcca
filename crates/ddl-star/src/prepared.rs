//! The batches of a training, made once.

use crate::StarError;
use crate::batch::SceneBatch;
use ddl_data::{WINDOW, Window};
use std::cell::OnceCell;
use tch::{Device, Kind};

/// Training windows as batches that stay where the network computes.
///
/// A schedule shuffles its windows once, so that every window belongs to one batch for good: a batch is
/// laid out (positions, who sees whom) and copied to the device at its first visit, and found there at
/// every later one.
#[derive(Debug)]
pub(crate) struct PreparedBatches {
    windows: Vec<Window>,
    neighbour_box: f64,
    device: Device,
    kind: Kind,
    made: Vec<OnceCell<SceneBatch>>,
}

impl PreparedBatches {
    /// Room for `count` batches of `windows`, each with its future.
    pub(crate) fn new(
        windows: Vec<Window>,
        count: usize,
        neighbour_box: f64,
        device: Device,
        kind: Kind,
    ) -> Self {
        Self {
            windows,
            neighbour_box,
            device,
            kind,
            made: (0..count).map(|_| OnceCell::new()).collect(),
        }
    }

    /// A window.
    pub(crate) fn window(&self, index: usize) -> &Window {
        &self.windows[index]
    }

    /// The batch of that number, which consists of `windows`, the same at every call.
    ///
    /// # Shapes
    /// All 20 frames, with neighbours of the first 19.
    ///
    /// # Errors
    /// Those of [`SceneBatch::new`].
    pub(crate) fn batch(&self, index: usize, windows: &[usize]) -> Result<&SceneBatch, StarError> {
        let place = &self.made[index];
        if let Some(batch) = place.get() {
            return Ok(batch);
        }
        let windows: Vec<&Window> = windows.iter().map(|&index| &self.windows[index]).collect();
        let batch = SceneBatch::new(
            &windows,
            WINDOW,
            WINDOW - 1,
            self.neighbour_box,
            self.device,
            self.kind,
        )?;
        Ok(place.get_or_init(|| batch))
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a test may panic")]

    use super::*;
    use ddl_data::{Dataset, WindowRule};

    #[test]
    fn a_batch_is_made_once_and_is_that_of_its_windows() {
        let dataset = Dataset::simulated(1);
        let windows = dataset.recordings()[0].windows(WindowRule::Complete);
        let (device, kind) = (Device::Cpu, Kind::Double);
        let prepared = PreparedBatches::new(windows.clone(), 2, 10.0, device, kind);
        let first = prepared.batch(1, &[3, 0]).unwrap();
        let some = [&windows[3], &windows[0]];
        let fresh = SceneBatch::new(&some, WINDOW, WINDOW - 1, 10.0, device, kind).unwrap();
        assert_eq!(first.positions(), fresh.positions());
        assert!(std::ptr::eq(first, prepared.batch(1, &[3, 0]).unwrap()));
        assert_eq!(prepared.window(3).start_frame(), windows[3].start_frame());
        assert!(prepared.batch(0, &[]).is_err());
    }
}
