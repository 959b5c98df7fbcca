//! The sieve of a sliding search: `f32` scores that exclude nearly every window, and never one of the nearest.

use crate::select::Selection;
use crate::sliding::accuracy::Accuracy;
use crate::sliding::kernel::WindowSweep;
use crate::sliding::layout::WindowLayout;
use ddl_simd::Dispatch;

/// Longest window of the general kernel.
const LONGEST: usize = 32;

/// The windows of all tracks, and the accuracy of their scores.
#[derive(Clone, Debug)]
pub(super) struct WindowSieve<const D: usize> {
    layout: WindowLayout<D>,
    accuracy: Accuracy,
}

impl<const D: usize> WindowSieve<D> {
    /// The sieve of a layout, or `None` if `f32` cannot hold its windows for any query.
    pub(super) fn new(layout: WindowLayout<D>) -> Option<Self> {
        let accuracy = Accuracy::of(layout.length())?;
        accuracy.margin_log2(accuracy.smallest_accurate_log2(), layout.largest_with(&[]), D)?;
        Some(Self { layout, accuracy })
    }

    /// For each window of `query`, the windows that may be among its `wanted` nearest, or `None` if `f32` is not
    /// accurate enough. `query` must have at least the steps of a window.
    pub(super) fn survivors(&self, dispatch: Dispatch, query: &[[f64; D]], wanted: usize) -> Vec<Option<Vec<usize>>> {
        let windows = query.len() + 1 - self.layout.length();
        let largest = self.layout.largest_with(query);
        let smallest = self.accuracy.smallest_accurate_log2();
        let Some(widest) = self.accuracy.margin_log2(smallest, largest, D) else {
            return vec![None; windows];
        };
        let mut selections: Vec<_> = (0..windows).map(|_| Selection::new(wanted, widest)).collect();
        self.sweep(dispatch, query, &mut selections);
        let margin = |nth_log2| self.accuracy.margin_log2(nth_log2, largest, D);
        let finish = |selection: Selection| selection.survivors(smallest, margin);
        selections.into_iter().map(finish).collect()
    }

    fn sweep(&self, dispatch: Dispatch, query: &[[f64; D]], selections: &mut [Selection]) {
        let query = self.layout.narrowing.narrow(query);
        match self.layout.length() {
            7 => self.sweep_of::<7, true>(dispatch, &query, selections),
            8 => self.sweep_of::<8, true>(dispatch, &query, selections),
            _ => self.sweep_of::<LONGEST, false>(dispatch, &query, selections),
        }
    }

    fn sweep_of<const M: usize, const EXACT: bool>(
        &self,
        dispatch: Dispatch,
        query: &[[f32; D]],
        selections: &mut [Selection],
    ) {
        dispatch.run_on_registers(WindowSweep::<D, M, EXACT> {
            layout: &self.layout,
            query,
            starts: self.accuracy.starts(),
            selections,
        });
    }
}

#[cfg(test)]
mod tests {
    use super::WindowSieve;
    use crate::select::Selection;
    use crate::sliding::layout::WindowLayout;
    use crate::{Cost, SoftDtw};
    use ddl_simd::{Dispatch, InstructionSet};

    type Track = Vec<[f64; 2]>;

    /// Velocities around a few walking directions, some of them nearly standing.
    fn walks(count: usize, steps: usize, offset: f64) -> Vec<Track> {
        let walk = |i: usize| {
            let (sin, cos) = (0.7 * i as f64).sin_cos();
            let speed = 0.013 * (i % 120) as f64;
            let sway = |j: usize| 0.2 * ((i * 31 + j * 17) as f64).sin() * speed;
            (0..steps + i % 5)
                .map(|j| [speed * cos + sway(j) + offset, speed * sin - sway(j)])
                .collect()
        };
        (0..count).map(walk).collect()
    }

    fn sieve(dtw: SoftDtw, tracks: &[Track], length: usize) -> (Option<WindowSieve<2>>, Vec<Track>, Vec<f64>) {
        let slices: Vec<&[[f64; 2]]> = tracks.iter().map(Vec::as_slice).collect();
        let counts: Vec<usize> = tracks.iter().map(|track| track.len() + 1 - length).collect();
        let windows = tracks.iter().flat_map(|track| track.windows(length));
        let windows: Vec<Track> = windows.map(<[_]>::to_vec).collect();
        let own: Vec<f64> = windows.iter().map(|window| dtw.self_value(window)).collect();
        let layout = WindowLayout::new(dtw.gamma(), &slices, &counts, length, &own);
        (WindowSieve::new(layout), windows, own)
    }

    #[test]
    fn scores_keep_their_error_bound() {
        for set in InstructionSet::available() {
            let dispatch = Dispatch::new(set).expect("available");
            let (mut worst, mut checked) = (0.0_f64, 0);
            for (length, gamma) in [(7, 1.0), (8, 1.0), (8, 0.2), (20, 1.0), (3, 0.05), (1, 1.0)] {
                let dtw = SoftDtw::new(gamma, Cost::SquaredEuclidean).expect("valid");
                let tracks = walks(60, length + 3, 0.0);
                let (sieve, windows, own) = sieve(dtw, &tracks, length);
                let sieve = sieve.expect("fits f32");
                let query = &walks(1, 3 * length + 2, 0.3)[0];
                let queries = query.len() + 1 - length;
                // A selection that wants more windows than there are keeps all of them.
                let all = || Selection::new(windows.len() + 1, 0.0);
                let mut selections: Vec<_> = (0..queries).map(|_| all()).collect();
                sieve.sweep(dispatch, query, &mut selections);
                let largest = sieve.layout.largest_with(query);
                for (x, selection) in query.windows(length).zip(selections) {
                    let mut kept = selection.finish(0.0);
                    kept.sort_by_key(|scored| scored.candidate);
                    assert!(kept.iter().map(|k| k.candidate).eq(0..windows.len()));
                    for scored in kept {
                        assert!(scored.score.is_normal());
                        let score = f64::from(scored.score).log2();
                        if score < sieve.accuracy.smallest_accurate_log2() {
                            continue;
                        }
                        let y = scored.candidate;
                        let value = dtw.value_unchecked(x, &windows[y]) - own[y] / 2.0;
                        let value_log2 = value * std::f64::consts::LOG2_E / gamma;
                        let exact = sieve.accuracy.start_log2() - value_log2;
                        let bound = sieve.accuracy.error_log2(score, largest, 2);
                        worst = worst.max((score - exact).abs() / bound);
                        checked += 1;
                    }
                }
            }
            assert!(checked > 10_000, "only {checked} scores are accurate");
            assert!(worst < 1.0, "{set}: an error {worst} times its bound");
            assert!(worst > 1e-3, "{set}: the bound is far too wide: {worst}");
        }
    }
}
