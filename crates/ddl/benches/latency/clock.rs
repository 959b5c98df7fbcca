//! Timing side by side with the machine's own product of matrices.

use crate::Result;
use ddl::star::{MatrixProduct, set_threads};
use rustix::time::{ClockId, clock_gettime};

/// Rows and columns of the matrices of the yardstick.
const MATRIX: usize = 1024;

#[derive(Clone, Copy)]
pub(crate) enum Clock {
    /// That of the processor, of all threads of the process together.
    Processor,
    /// That of the wall.
    Wall,
}

impl Clock {
    fn now(self) -> f64 {
        let time = clock_gettime(match self {
            Self::Processor => ClockId::ProcessCPUTime,
            Self::Wall => ClockId::Monotonic,
        });
        time.tv_sec as f64 + 1e-9 * time.tv_nsec as f64
    }

    fn seconds<T>(self, work: impl FnOnce() -> Result<T>) -> Result<f64> {
        let before = self.now();
        work()?;
        Ok(self.now() - before)
    }
}

/// What something costs, and what the machine could do at the time.
#[derive(Clone, Copy)]
pub(crate) struct Measured {
    /// Median, seconds.
    pub(crate) seconds: f64,
    /// Multiplications and additions a second of the product of matrices, median.
    pub(crate) matrix_rate: f64,
}

/// Runs everything in turn, each right after a product of matrices on `threads` threads; first once without looking at the
/// clock. As [`ddl::prepare`] has it, libtorch has one thread for the rest.
pub(crate) fn side_by_side<const N: usize>(
    clock: Clock,
    threads: usize,
    turns: usize,
    mut works: [&mut dyn FnMut() -> Result<()>; N],
) -> Result<[Measured; N]> {
    let mut product = MatrixProduct::new(MATRIX)?;
    let mut multiply = || Ok(product.multiply()?);
    let mut times: [Vec<[f64; 2]>; N] = std::array::from_fn(|_| Vec::new());
    for turn in 0..=turns {
        for (work, times) in works.iter_mut().zip(&mut times) {
            set_threads(threads);
            let yardstick = clock.seconds(&mut multiply)?;
            set_threads(1);
            let seconds = clock.seconds(work)?;
            if turn > 0 {
                times.push([seconds, yardstick]);
            }
        }
    }
    let operations = product.operations() as f64;
    Ok(times.map(|times| Measured {
        seconds: median(times.iter().map(|pair| pair[0])),
        matrix_rate: operations / median(times.iter().map(|pair| pair[1])),
    }))
}

fn median(numbers: impl Iterator<Item = f64>) -> f64 {
    let mut numbers: Vec<f64> = numbers.collect();
    numbers.sort_by(f64::total_cmp);
    numbers[numbers.len() / 2]
}
