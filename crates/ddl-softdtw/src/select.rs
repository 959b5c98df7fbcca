//! Running selection of the largest scores, with a band below the n-th score for candidates that may belong to the
//! best.

#[derive(Clone, Copy, Debug)]
pub(crate) struct Scored {
    pub(crate) score: f32,
    pub(crate) candidate: usize,
}

/// Keeps every score that may be at least `slack` times the `wanted`-th largest.
#[derive(Debug)]
pub(crate) struct Selection {
    wanted: usize,
    /// Factor below 1: a score of at least `slack` times the n-th is kept.
    slack: f64,
    /// Smallest score that is kept: `slack` times the n-th largest so far. It only grows.
    pub(crate) threshold: f32,
    capacity: usize,
    kept: Vec<Scored>,
}

impl Selection {
    /// Selects the `wanted` (at least 1) largest scores and those down to 2^−`margin_log2` times the last of them.
    pub(crate) fn new(wanted: usize, margin_log2: f64) -> Self {
        let capacity = 4 * wanted.max(64);
        Self { wanted, slack: (-margin_log2).exp2(), threshold: 0.0, capacity, kept: Vec::with_capacity(capacity) }
    }

    pub(crate) fn offer(&mut self, score: f32, candidate: usize) {
        if score < self.threshold {
            return;
        }
        self.kept.push(Scored { score, candidate });
        if self.kept.len() >= self.capacity {
            self.compact(self.slack);
            // Many ties may be kept; a larger capacity keeps compaction rare.
            self.capacity = self.capacity.max(2 * self.kept.len());
        }
    }

    /// The `wanted`-th largest score, or `None` when fewer were offered.
    pub(crate) fn nth(&mut self) -> Option<f32> {
        let last = self.wanted.checked_sub(1)?;
        if self.kept.len() <= last {
            return None;
        }
        let (_, nth, _) = self.kept.select_nth_unstable_by(last, |a, b| b.score.total_cmp(&a.score));
        Some(nth.score)
    }

    /// The scores that remain after a last compaction, with a margin that may be narrower than that of the selection.
    pub(crate) fn finish(mut self, margin_log2: f64) -> Vec<Scored> {
        self.compact((-margin_log2).exp2().max(self.slack));
        self.kept
    }

    /// The candidates that may be among the best. `None` if too few were offered, if the score of the last one is below
    /// `smallest_log2`, or if there is no margin for its score (log2).
    pub(crate) fn survivors(
        mut self,
        smallest_log2: f64,
        margin_log2: impl FnOnce(f64) -> Option<f64>,
    ) -> Option<Vec<usize>> {
        let nth_log2 = f64::from(self.nth()?).log2();
        if nth_log2 < smallest_log2 {
            return None;
        }
        Some(self.finish(margin_log2(nth_log2)?).iter().map(|scored| scored.candidate).collect())
    }

    fn compact(&mut self, slack: f64) {
        if let Some(nth) = self.nth() {
            let threshold = (f64::from(nth) * slack) as f32;
            // Rounded down, so that the band is not narrower than requested.
            self.threshold = self.threshold.max(threshold.next_down());
            let threshold = self.threshold;
            self.kept.retain(|scored| scored.score >= threshold);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Selection;

    #[test]
    fn keeps_the_best_and_the_band_below_them() {
        let mut selection = Selection::new(3, 1.0);
        for i in 0..5000_usize {
            let score = ((i * 7919) % 5000) as f32;
            selection.offer(score, i);
        }
        assert_eq!(selection.nth(), Some(4997.0));
        let mut kept: Vec<f32> = selection.finish(0.001).iter().map(|s| s.score).collect();
        kept.sort_by(f32::total_cmp);
        assert_eq!(kept, [4994.0, 4995.0, 4996.0, 4997.0, 4998.0, 4999.0]);
    }
}
