//! Measures several pieces of work in turns, with empty caches.

use crate::Result;
use rustix::time::{ClockId, clock_gettime};
use std::hint::black_box;

/// Bytes read to empty the caches: more than they hold.
const CACHES: usize = 256 << 20;

#[derive(Debug, Clone, Copy)]
pub(crate) enum MeasuredTime {
    /// Processor time of all threads of the process.
    Processor,
    /// Of the clock on the wall.
    Wall,
}

impl MeasuredTime {
    fn now(self) -> f64 {
        let time = clock_gettime(match self {
            Self::Processor => ClockId::ProcessCPUTime,
            Self::Wall => ClockId::Monotonic,
        });
        time.tv_sec as f64 + 1e-9 * time.tv_nsec as f64
    }

    pub(crate) fn seconds<T>(self, work: impl FnOnce() -> Result<T>) -> Result<f64> {
        let before = self.now();
        work()?;
        Ok(self.now() - before)
    }
}

/// Seconds of each piece of work, as the median of the turns. The caches are emptied before each piece; the first turn
/// does not count.
pub(crate) fn side_by_side<const N: usize>(
    clock: MeasuredTime,
    turns: usize,
    mut works: [&mut dyn FnMut() -> Result<()>; N],
) -> Result<[f64; N]> {
    let mut bytes = vec![0_u8; CACHES];
    let mut times: [Vec<f64>; N] = std::array::from_fn(|_| Vec::new());
    for turn in 0..=turns {
        for (work, times) in works.iter_mut().zip(&mut times) {
            black_box(&mut bytes).fill(turn as u8);
            let seconds = clock.seconds(work)?;
            if turn > 0 {
                times.push(seconds);
            }
        }
    }
    Ok(times.map(median))
}

fn median(mut numbers: Vec<f64>) -> f64 {
    numbers.sort_by(f64::total_cmp);
    numbers[numbers.len() / 2]
}
