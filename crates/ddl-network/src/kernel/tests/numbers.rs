//! Random numbers for tests, comparison of results, and expected panics.

use fastrand::Rng;
use std::panic::{AssertUnwindSafe, catch_unwind};

/// A generator of reproducible numbers.
pub(crate) struct SeededNumbers(Rng);

impl SeededNumbers {
    pub(crate) fn seeded(seed: u64) -> Self {
        Self(Rng::with_seed(seed))
    }

    /// Uniform in [−`bound`, `bound`].
    pub(crate) fn even(&mut self, count: usize, bound: f32) -> Vec<f32> {
        (0..count).map(|_| bound * (2.0 * self.0.f32() - 1.0)).collect()
    }

    /// Visibility masks: a pedestrian sees itself, and others with probability 3/4.
    pub(crate) fn visible(&mut self, sizes: &[usize], frames: usize) -> Vec<bool> {
        let mut visible = Vec::new();
        for size in sizes.repeat(frames) {
            for i in 0..size {
                visible.extend((0..size).map(|j| i == j || self.0.u8(..4) > 0));
            }
        }
        visible
    }
}

/// Visible pedestrians of each pedestrian, from the square masks of all scenes and frames.
pub(crate) fn lists(sizes: &[usize], mut visible: &[bool]) -> Vec<Vec<u32>> {
    let mut lists = Vec::new();
    while !visible.is_empty() {
        for &size in sizes.iter().flat_map(|size| std::iter::repeat_n(size, *size)) {
            let row = visible.split_off(..size).unwrap();
            let seen = (0..).zip(row).filter(|(_, seen)| **seen);
            lists.push(seen.map(|(key, _)| key).collect());
        }
    }
    lists
}

/// Panics if a result differs from the expected one by more than `tolerance` times the largest of all.
pub(crate) fn assert_close(what: &str, results: &[f32], expected: &[f64], tolerance: f64) {
    assert_eq!(results.len(), expected.len(), "{what}");
    let largest = expected.iter().fold(1e-3_f64, |a, b| a.max(b.abs()));
    for (i, (result, expected)) in results.iter().zip(expected).enumerate() {
        let error = (f64::from(*result) - expected).abs() / largest;
        assert!(error <= tolerance, "{what} {i}: {result} for {expected}, error {error:e} of the largest");
    }
}

pub(crate) fn wide(numbers: &[f32]) -> Vec<f64> {
    numbers.iter().map(|&number| f64::from(number)).collect()
}

pub(crate) fn bits(numbers: &[f32]) -> Vec<u32> {
    numbers.iter().map(|number| number.to_bits()).collect()
}

pub(crate) fn assert_refused(said: &str, run: impl FnOnce()) {
    let panic = catch_unwind(AssertUnwindSafe(run)).expect_err(said);
    let message = match panic.downcast_ref::<String>() {
        Some(message) => message,
        None => *panic.downcast_ref::<&str>().unwrap_or(&"no message"),
    };
    assert!(message.contains(said), "{message:?} says nothing of {said:?}");
}
