//! Scores of all windows of a query track against all windows of a group of pieces.
//!
//! K(i, j) = 2^−|x(i) − y(j)|² is computed once for each step i of the query and each step j of a piece, for all pairs
//! of windows that contain both steps. Neighbouring pairs share even more. Let `length` rows of the query be a block,
//! and c its last row. Every window that starts in the block crosses row c. So its sum over all warping paths can be
//! split at the last cell m = (c, j) of a path in that row:
//!
//! ```text
//! Z(s, t) = Σ over j of F(j, s) B(j, t)
//! F(j, s) = Σ over paths s → m,   B(j, t) = Σ over paths m → t that leave row c at once
//! ```
//!
//! (F includes the cells from s to m, B the cells after m.) One recursion backwards from m gives F(j, s) for every
//! first cell s, and one forwards gives B(j, t) for every last cell t. So a pair of windows costs two columns of cells
//! and a sum of `length` products. All terms are positive, so nothing cancels.

#![expect(clippy::inline_always, reason = "the lanes must stay in registers")]

use crate::select::Selection;
use crate::sliding::accuracy::FLOOR;
use crate::sliding::column::{Column, Setting, advance_back, advance_front, similarities};
use crate::sliding::hits::Hits;
use crate::sliding::layout::WindowLayout;
use ddl_simd::{LANES, Register, RegisterKernel};

/// All windows of a query against all windows of the layout. `M` is the number of steps of a window; with `EXACT`
/// false, a window may be shorter.
pub(super) struct WindowSweep<'a, const D: usize, const M: usize, const EXACT: bool> {
    pub(super) layout: &'a WindowLayout<D>,
    /// Steps of the query, at least one window.
    pub(super) query: &'a [[f32; D]],
    pub(super) starts: (f32, f32),
    /// The selections that receive the scores, one for each window of the query.
    pub(super) selections: &'a mut [Selection],
}

struct SweepMemory<S: Register, const M: usize> {
    /// K of a block of query rows at every step of the pieces, and of the block below it.
    above: Vec<Column<S, M>>,
    below: Vec<Column<S, M>>,
    /// B(j) and B(j + 1): entry `[q][r]` is for the last cell (c + 1 + r, j + q).
    backs: [[Column<S, M>; M]; 2],
    /// Unfinished Z: entry `[k]` is for the first row c − k. Window b of the pieces is at b modulo their number.
    sums: Vec<Column<S, M>>,
}

impl<const D: usize, const M: usize, const EXACT: bool> RegisterKernel for WindowSweep<'_, D, M, EXACT> {
    type Output = ();

    #[inline(always)]
    fn run<S: Register>(self, simd: S) {
        let rows = if EXACT { M } else { self.layout.length() };
        let (zero, one) = (simd.splat(0.0), simd.splat(1.0));
        let mut setting = Setting {
            simd,
            rows,
            part: 0,
            zero,
            floor: simd.splat(FLOOR),
            front: simd.splat(self.starts.0),
            back: simd.splat(self.starts.1),
        };
        let mut memory = SweepMemory::<S, M> {
            above: Vec::new(),
            below: Vec::new(),
            backs: [[[zero; M]; M]; 2],
            sums: vec![[zero; M]; rows.next_power_of_two()],
        };
        let windows = self.selections.len();
        let mut hits = Hits::new(self.selections, rows);
        for group in self.layout.groups() {
            let steps = group.samples.len();
            hits.weights = group.weights;
            hits.first_windows = group.first_windows;
            if memory.above.len() < steps {
                memory.above.resize(steps, [one; M]);
                memory.below.resize(steps, [one; M]);
            }
            for part in 0..S::PARTS {
                setting.part = part;
                let mut blocks = self.query.chunks(rows);
                if let Some(block) = blocks.next() {
                    similarities(setting, group.samples, block, &mut memory.above);
                }
                let mut first = 0;
                while first < windows {
                    hits.open(first);
                    match blocks.next() {
                        Some(block) => {
                            similarities(setting, group.samples, block, &mut memory.below);
                            pairs(setting, steps, &mut memory, &mut hits);
                        }
                        // The query ends with the block: its first row starts the only window.
                        None => last_window(setting, &memory, &mut hits),
                    }
                    std::mem::swap(&mut memory.above, &mut memory.below);
                    first += rows;
                }
            }
        }
    }
}

/// Scores of the windows that start in the rows of `memory.above`. F(j) is computed together with B(j + 1), because
/// each is a chain of dependent operations and two chains hide the latency.
#[inline(always)]
fn pairs<S: Register, const M: usize>(
    setting: Setting<S>,
    steps: usize,
    memory: &mut SweepMemory<S, M>,
    hits: &mut Hits<'_>,
) {
    let Setting { rows, zero, .. } = setting;
    let (above, below) = (&memory.above[..steps], &memory.below[..steps]);
    let [backs, next_backs] = &mut memory.backs;
    let sums = &mut memory.sums[..];
    let (mut backs, mut next_backs) = (backs, next_backs);
    let mut back = [zero; M];
    for (q, k) in below.iter().take(rows).enumerate() {
        advance_back(setting, k, q, &mut back, backs);
    }
    for j in 0..steps {
        let (mut front, mut back) = ([zero; M], [zero; M]);
        let depth = rows.min(j + 1);
        let reach = rows.min(steps - j - 1);
        let both = depth.min(reach);
        for l in 0..both {
            advance_back(setting, &below[j + 1 + l], l, &mut back, next_backs);
            advance_front(setting, &above[j - l], l, &mut front);
            add_products(setting, j - l, l, &front, backs, sums, hits);
        }
        for q in both..reach {
            advance_back(setting, &below[j + 1 + q], q, &mut back, next_backs);
        }
        for l in both..depth {
            advance_front(setting, &above[j - l], l, &mut front);
            add_products(setting, j - l, l, &front, backs, sums, hits);
        }
        std::mem::swap(&mut backs, &mut next_backs);
    }
}

/// Adds F(j) B(j) to the sums of the pairs whose window of the pieces begins in column j − l, and offers the complete
/// sums.
#[inline(always)]
fn add_products<S: Register, const M: usize>(
    setting: Setting<S>,
    window: usize,
    l: usize,
    front: &Column<S, M>,
    backs: &[Column<S, M>; M],
    sums: &mut [Column<S, M>],
    hits: &mut Hits<'_>,
) {
    let Setting { simd, rows, .. } = setting;
    if window >= hits.weights.len() {
        return;
    }
    let back = &backs[rows - 1 - l];
    let mask = sums.len() - 1;
    let sum = &mut sums[window & mask];
    if l == 0 {
        for k in 0..rows - 1 {
            sum[k] = simd.mul(front[k], back[rows - 2 - k]);
        }
    } else {
        for k in 0..rows - 1 {
            sum[k] = simd.mul_add(front[k], back[rows - 2 - k], sum[k]);
        }
    }
    if l == rows - 1 {
        // Windows that end in row c end in m, so B has no cells.
        sum[rows - 1] = simd.mul(front[rows - 1], setting.back);
        compare(setting, window, sum, hits);
    }
}

#[inline(always)]
fn compare<S: Register, const M: usize>(setting: Setting<S>, window: usize, sum: &Column<S, M>, hits: &mut Hits<'_>) {
    let Setting { simd, rows, part, .. } = setting;
    let weight = simd.load(&hits.weights[window].0, part);
    let thresholds = &hits.thresholds[..rows];
    let mut reached = [0; M];
    let mut any = 0;
    for k in 0..rows {
        let threshold = simd.splat(thresholds[k]);
        reached[k] = simd.at_least(simd.mul(sum[k], weight), threshold);
        any |= reached[k];
    }
    if any != 0 {
        let mut scores = [[0.0; LANES]; M];
        for k in 0..rows {
            simd.store(simd.mul(sum[k], weight), &mut scores[k], part);
        }
        let first_lane = part * S::WIDTH;
        hits.offer(&reached[..rows], &scores, first_lane, window);
    }
}

/// Scores of the window that consists of the rows of `memory.above`, by the plain recursion.
#[inline(always)]
fn last_window<S: Register, const M: usize>(setting: Setting<S>, memory: &SweepMemory<S, M>, hits: &mut Hits<'_>) {
    let Setting { simd, rows, .. } = setting;
    let windows = hits.weights.len();
    for window in (0..windows).step_by(2) {
        // Two at a time, because a single chain of dependent operations would not hide the latency.
        let next = (window + 1).min(windows - 1);
        let (mut state, mut next_state) = ([setting.zero; M], [setting.zero; M]);
        for l in 0..rows {
            let last = rows - 1 - l;
            advance_front(setting, &memory.above[window + last], l, &mut state);
            advance_front(setting, &memory.above[next + last], l, &mut next_state);
        }
        state[rows - 1] = simd.mul(state[rows - 1], setting.back);
        compare(setting, window, &state, hits);
        if next != window {
            next_state[rows - 1] = simd.mul(next_state[rows - 1], setting.back);
            compare(setting, next, &next_state, hits);
        }
    }
}
