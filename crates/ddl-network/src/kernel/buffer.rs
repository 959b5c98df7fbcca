//! Reusable memory for rows of numbers.

use ddl_simd::LANES;
use std::cell::RefCell;
use std::marker::PhantomData;
use std::ops::{Deref, DerefMut};

/// Number of free buffers that a thread keeps for its next work, while no [`KeepBuffers`] lives. For small batches the
/// system's allocation takes as long as the work.
const SPARE: usize = 64;
/// Largest total size of these buffers, in numbers (32 MiB), so that the memory of a crowded frame is freed after it.
const SPARE_NUMBERS: usize = 1 << 23;

struct Spares {
    buffers: Vec<Vec<f32>>,
    numbers: usize,
    /// Number of living [`KeepBuffers`] of this thread.
    keeping: usize,
}

thread_local! {
    static SPARES: RefCell<Spares> = const {
        RefCell::new(Spares {
            buffers: Vec::new(),
            numbers: 0,
            keeping: 0,
        })
    };
}

impl Spares {
    /// The smallest free buffer that holds `count` numbers, or a new one. Of several equal ones it is the newest, which
    /// is most likely still in the processor's cache.
    fn take(&mut self, count: usize) -> Vec<f32> {
        let lengths = || self.buffers.iter().map(Vec::len).enumerate().rev();
        let fitting = lengths().filter(|&(_, length)| length >= count);
        // Most buffers are as long as one before, and soon found.
        let equal = lengths().find(|&(_, length)| length == count);
        if let Some((index, length)) = equal.or_else(|| fitting.min_by_key(|&(_, length)| length)) {
            self.numbers -= length;
            return self.buffers.remove(index);
        }
        // Drops a free buffer that is too small, so that the number of buffers does not grow.
        if !self.buffers.is_empty() {
            self.numbers -= self.buffers.remove(0).len();
        }
        vec![0.0; count]
    }

    fn keep(&mut self, buffer: Vec<f32>) {
        let fits = self.buffers.len() < SPARE && self.numbers + buffer.len() <= SPARE_NUMBERS;
        if fits || self.keeping > 0 {
            self.numbers += buffer.len();
            self.buffers.push(buffer);
        }
    }

    /// Drops the oldest buffers beyond the limits.
    fn trim(&mut self) {
        while !self.buffers.is_empty() && (self.buffers.len() > SPARE || self.numbers > SPARE_NUMBERS) {
            self.numbers -= self.buffers.remove(0).len();
        }
    }
}

/// Makes this thread's list of free buffers. The first use asks the C heap for memory, for what drops it at the end.
pub(super) fn prepare_thread() {
    SPARES.with(|_| ());
}

/// While it lives, its thread keeps all free buffers. In a parallel loop it lives as long as one job of rayon: one
/// hypothesis of a crowd or several.
///
/// The number of buffers is bounded by those in use at the same time. It is not `Send`, because it must be dropped on
/// its thread.
#[derive(Debug)]
pub(crate) struct KeepBuffers(PhantomData<*const ()>);

impl KeepBuffers {
    pub(crate) fn new() -> Self {
        SPARES.with_borrow_mut(|spares| spares.keeping += 1);
        Self(PhantomData)
    }
}

impl Drop for KeepBuffers {
    fn drop(&mut self) {
        // When a thread ends, its free buffers may already be dropped.
        let _ = SPARES.try_with(|spares| {
            let mut spares = spares.borrow_mut();
            spares.keeping -= 1;
            if spares.keeping == 0 {
                spares.trim();
            }
        });
    }
}

/// Numbers in memory aligned to the width of a vector register.
#[derive(Debug, Default)]
pub struct Buffer {
    numbers: Vec<f32>,
    first: usize,
    count: usize,
}

impl Buffer {
    /// `count` numbers with arbitrary contents.
    pub fn any(count: usize) -> Self {
        let numbers = SPARES.with_borrow_mut(|spares| spares.take(count + LANES));
        let aligned = numbers.as_ptr().align_offset(LANES * size_of::<f32>());
        let first = if aligned < LANES { aligned } else { 0 };
        Self { numbers, first, count }
    }

    /// `count` zeros.
    pub(crate) fn zeros(count: usize) -> Self {
        let mut buffer = Self::any(count);
        buffer.fill(0.0);
        buffer
    }

    pub(super) fn many_zeros(buffers: usize, count: usize) -> Vec<Self> {
        (0..buffers).map(|_| Self::zeros(count)).collect()
    }

    /// A copy of these numbers.
    pub fn copy(numbers: &[f32]) -> Self {
        let mut buffer = Self::any(numbers.len());
        buffer.copy_from_slice(numbers);
        buffer
    }
}

impl Clone for Buffer {
    fn clone(&self) -> Self {
        Self::copy(self)
    }
}

impl Deref for Buffer {
    type Target = [f32];

    fn deref(&self) -> &[f32] {
        &self.numbers[self.first..][..self.count]
    }
}

impl DerefMut for Buffer {
    fn deref_mut(&mut self) -> &mut [f32] {
        &mut self.numbers[self.first..][..self.count]
    }
}

impl Drop for Buffer {
    fn drop(&mut self) {
        let numbers = std::mem::take(&mut self.numbers);
        if numbers.is_empty() {
            return;
        }
        // When a thread ends, its free buffers may already be dropped.
        let _ = SPARES.try_with(|spares| spares.borrow_mut().keep(numbers));
    }
}

/// Adds terms to sums, as far as both reach.
pub(crate) fn add_to(sums: &mut [f32], terms: &[f32]) {
    for (sum, term) in sums.iter_mut().zip(terms) {
        *sum += term;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_kept_is_bounded() {
        let check = |least: usize| {
            SPARES.with_borrow(|spares| {
                let numbers: usize = spares.buffers.iter().map(Vec::len).sum();
                assert_eq!(numbers, spares.numbers);
                assert!(spares.buffers.len() <= SPARE, "{} buffers", spares.buffers.len());
                assert!((least..=SPARE_NUMBERS).contains(&numbers), "{numbers} numbers");
            });
        };
        for size in [16, 1 << 20] {
            let many: Vec<Buffer> = (0..100).map(|_| Buffer::any(size)).collect();
            let [outer, inner] = [0; 2].map(|_| KeepBuffers::new());
            drop(many);
            drop(inner);
            assert!(SPARES.with_borrow(|spares| spares.numbers) >= 100 * size);
            drop(outer);
            check(SPARE_NUMBERS.min(SPARE * size) / 2);
        }
        drop(Buffer::any(2 * SPARE_NUMBERS));
        check(1);
    }

    #[test]
    fn the_smallest_spare_that_is_large_enough_is_taken() {
        drop([300, 100, 200].map(Buffer::any));
        let again = [150, 250, 50].map(Buffer::any);
        let lengths = again.each_ref().map(|buffer| buffer.numbers.len() - LANES);
        assert_eq!(lengths, [200, 300, 100]);
        assert_eq!(Buffer::any(60).numbers.len() - LANES, 60);
    }

    #[test]
    fn buffers_are_aligned_and_as_long_as_asked_for() {
        for count in [0, 1, 17, 1000, 3, 500] {
            let buffer = Buffer::zeros(count);
            assert_eq!(buffer.len(), count);
            assert!(buffer.iter().all(|&number| number == 0.0));
            assert_eq!(buffer.as_ptr().align_offset(64), 0, "{count}");
            let mut copy = Buffer::copy(&buffer);
            copy.fill(1.0);
            assert!(buffer.iter().all(|&number| number == 0.0));
        }
        assert!(Buffer::default().is_empty());
    }
}
