//! Completion of observations that begin late or have gaps.

use ddl_core::{CompletionCounts, OBSERVED, Position, is_finite};

use crate::observation::between;

/// Which of the 8 observed positions may be filled in, for pedestrians that were not observed at all 8 steps.
///
/// - A *gap* of a few frames is filled on the straight line between the positions before and after it.
/// - An observation that *begins late* is padded at its start, with the mean velocity of the rest.
///
/// The last position is always an observed one.
/// [`Window::completion_counts`](crate::Window::completion_counts) counts the positions filled in.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Completion {
    least_seen: usize,
    longest_gap: usize,
}

impl Completion {
    /// Fills in nothing: only pedestrians seen in each of the 8 frames are forecast.
    pub const NONE: Self = Self {
        least_seen: OBSERVED,
        longest_gap: 0,
    };
    /// Forecasts pedestrians seen at least twice, and fills gaps of up to 2 frames: the default of `ddl` and of the
    /// Python package. A [`LiveTracks`](crate::LiveTracks) without a completion fills in nothing.
    pub const DEFAULT: Self = Self {
        // A single position does not show where a pedestrian is going.
        least_seen: 2,
        longest_gap: 2,
    };

    /// Length of the longest gap that is filled, in frames.
    pub(crate) fn longest_gap(self) -> usize {
        self.longest_gap
    }

    /// The 8 positions up to the last of `seen` (raw frames and m, in order of time), one every `step` raw frames, and
    /// which of them were filled in. `None` if the completion does not allow it.
    pub(crate) fn observation(
        self,
        seen: impl DoubleEndedIterator<Item = (i64, Position)>,
        step: i64,
    ) -> Option<([Position; OBSERVED], CompletionCounts)> {
        let mut earlier = seen.rev();
        let (until, last) = earlier.next()?;
        let mut positions = [last; OBSERVED];
        let (mut reached, mut filled) = (1, 0);
        // The observation at this frame, or else the first one after it.
        let mut after = (until, last);
        let mut before = earlier.next();
        let longest = (self.longest_gap as i64 + 1) * step;
        for place in (0..OBSERVED - 1).rev() {
            let frame = until - (OBSERVED - 1 - place) as i64 * step;
            while let Some(seen) = before.filter(|(seen, _)| *seen >= frame) {
                after = seen;
                before = earlier.next();
            }
            positions[place] = if after.0 == frame {
                after.1
            } else {
                let gap = before.filter(|_| self.longest_gap > 0);
                let Some(before) = gap.filter(|(seen, _)| after.0 - seen <= longest) else {
                    break;
                };
                filled += 1;
                between(before, after, frame)
            };
            reached += 1;
        }
        if reached - filled < self.least_seen {
            return None;
        }
        let padded = OBSERVED - reached;
        let first = positions[padded];
        let steps = (reached - 1) as f64;
        for (place, position) in positions[..padded].iter_mut().enumerate() {
            let back = (padded - place) as f64 / steps;
            *position = [0, 1].map(|axis| first[axis] - back * (last[axis] - first[axis]));
        }
        // Interpolation between extremely large positions may overflow to NaN.
        let finite = positions.iter().all(|&position| is_finite(position));
        finite.then_some((positions, CompletionCounts { padded, filled }))
    }
}
