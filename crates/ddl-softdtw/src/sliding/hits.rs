//! Passes the scores of the kernel to the selections of the windows of a query.

use crate::select::Selection;
use ddl_simd::{LANES, Lanes};

/// The selections of a query, and the thresholds of scores for the windows of the current block.
pub(super) struct Hits<'a> {
    selections: &'a mut [Selection],
    /// Windows that start before the block.
    first: usize,
    /// Entry k is for the window that starts k rows before the end of the block.
    pub(super) thresholds: Vec<f32>,
    /// Weights of the windows of the group, and the first window of each of its lanes.
    pub(super) weights: &'a [Lanes],
    pub(super) first_windows: &'a [usize; LANES],
}

impl<'a> Hits<'a> {
    pub(super) fn new(selections: &'a mut [Selection], rows: usize) -> Self {
        Self {
            selections,
            first: 0,
            thresholds: vec![f32::INFINITY; rows],
            weights: &[],
            first_windows: &[0; LANES],
        }
    }

    /// Begins the block whose first row starts window `first`.
    #[inline]
    pub(super) fn open(&mut self, first: usize) {
        self.first = first;
        let rows = self.thresholds.len();
        for k in 0..rows {
            self.thresholds[k] = match self.selections.get(first + rows - 1 - k) {
                Some(selection) => least(selection),
                None => f32::INFINITY,
            };
        }
    }

    /// Offers the scores of one window of each piece: for each k, those whose bit is set in `reached`.
    #[inline(never)]
    pub(super) fn offer(&mut self, reached: &[u32], scores: &[[f32; LANES]], first_lane: usize, window: usize) {
        let last = self.first + self.thresholds.len() - 1;
        for (k, (&reached, scores)) in reached.iter().zip(scores).enumerate() {
            if reached == 0 {
                continue;
            }
            let selection = &mut self.selections[last - k];
            let mut left = reached;
            while left != 0 {
                let lane = first_lane + left.trailing_zeros() as usize;
                selection.offer(scores[lane], self.first_windows[lane] + window);
                left &= left - 1;
            }
            self.thresholds[k] = least(selection);
        }
    }
}

/// At least the smallest normal number, because the score 0 marks an entry without a window.
fn least(selection: &Selection) -> f32 {
    selection.threshold().max(f32::MIN_POSITIVE)
}
