//! Scores of all windows of a query track against all windows of a group of pieces.
//!
//! K(i, j) = 2^−|x(i) − y(j)|² is computed once for each step i of the query and each step j of a piece, and serves every
//! pair of windows that holds both. Neighbouring pairs share more than that. Let `length` rows of the query be a block and
//! c its last row. Every window that starts in the block crosses row c, so that its sum over all warping paths splits at
//! the last cell m = (c, j) a path has in that row:
//!
//! ```text
//! Z(s, t) = Σ over j of F(j, s) B(j, t)
//! F(j, s) = Σ over paths s → m,   B(j, t) = Σ over paths m → t that leave row c at once
//! ```
//!
//! (F counts the cells s to m, B those behind m). One recursion from m backwards gives F(j, s) for every first cell s at once,
//! one forwards gives B(j, t) for every last cell t, and both serve all `length`² pairs of windows that m lies in: a pair of
//! windows costs two columns of cells and a sum of `length` products, where its own recursion would take `length` columns.
//! All terms are positive, so that nothing cancels: the relative error is that of the plain recursion.

#![expect(clippy::inline_always, reason = "the lanes must stay in registers")]

use crate::lanes::{Kernel, LANES, Lanes, Simd};
use crate::select::Selection;
use crate::sliding::accuracy::{COST_CEILING, FLOOR};
use crate::sliding::layout::Layout;

/// All windows of a query against all windows of the layout.
///
/// `M` is the number of steps of a window; with `EXACT` false, a window may be shorter.
pub(super) struct Sweep<'a, const D: usize, const M: usize, const EXACT: bool> {
    pub(super) layout: &'a Layout<D>,
    /// Steps of the query, at least one window.
    pub(super) query: &'a [[f32; D]],
    /// What the paths before and behind the cut start from.
    pub(super) starts: (f32, f32),
    /// Takes the scores; one for each window of the query.
    pub(super) selections: &'a mut [Selection],
}

/// One number for every row of a block.
type Column<S, const M: usize> = [<S as Simd>::Narrow; M];

/// Working memory of a sweep.
struct Memory<S: Simd, const M: usize> {
    /// K of a block of query rows at every step of the pieces, and of the block below it.
    above: Vec<Column<S, M>>,
    below: Vec<Column<S, M>>,
    /// B(j) and B(j + 1): entry [q][r] is for the last cell (c + 1 + r, j + q).
    backs: [[Column<S, M>; M]; 2],
    /// Unfinished Z: entry [k] is for the first row c − k. Window b of the pieces is at b modulo the length.
    sums: Vec<Column<S, M>>,
}

/// What does not change during a sweep.
#[derive(Clone, Copy)]
struct Setting<S: Simd> {
    simd: S,
    rows: usize,
    part: usize,
    zero: S::Narrow,
    floor: S::Narrow,
    front: S::Narrow,
    back: S::Narrow,
}

impl<const D: usize, const M: usize, const EXACT: bool> Kernel for Sweep<'_, D, M, EXACT> {
    type Output = ();

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) {
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
        let mut memory = Memory::<S, M> {
            above: Vec::new(),
            below: Vec::new(),
            backs: [[[zero; M]; M]; 2],
            sums: vec![[zero; M]; rows.next_power_of_two()],
        };
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
                while first < hits.selections.len() {
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

/// K of the steps of `block` and all `samples`, a column for each of the samples.
#[inline(always)]
fn similarities<S: Simd, const D: usize, const M: usize>(
    setting: Setting<S>,
    samples: &[[Lanes; D]],
    block: &[[f32; D]],
    into: &mut [Column<S, M>],
) {
    let simd = setting.simd;
    let lowest = simd.splat(-COST_CEILING);
    for (sample, column) in samples.iter().zip(into) {
        for (step, k) in block.iter().zip(column) {
            let mut exponent = setting.zero;
            for d in 0..D {
                let other = simd.load(&sample[d], setting.part);
                let difference = simd.sub(simd.splat(step[d]), other);
                exponent = simd.neg_mul_add(difference, difference, exponent);
            }
            *k = simd.exp2(simd.max(exponent, lowest));
        }
    }
}

/// The next column of a recursion: `state` holds the column before it, `edge` enters the first row from outside.
///
/// Row r of the recursion is row r of `k`, or with `UPWARDS` the r-th of its last `rows` from the end.
#[inline(always)]
fn advance<S: Simd, const M: usize, const UPWARDS: bool>(
    setting: Setting<S>,
    rows: usize,
    k: &Column<S, M>,
    state: &mut Column<S, M>,
    edge: S::Narrow,
) {
    let (simd, floor) = (setting.simd, setting.floor);
    if rows == 0 {
        return;
    }
    let row = |r: usize| if UPWARDS { rows - 1 - r } else { r };
    let mut diagonal = state[0];
    let mut up = simd.mul_add(k[row(0)], simd.add(diagonal, edge), floor);
    state[0] = up;
    for r in 1..rows {
        let (k, left) = (k[row(r)], state[r]);
        // `up` is the one that is waited for: it comes last.
        let others = simd.mul_add(k, simd.add(left, diagonal), floor);
        up = simd.mul_add(k, up, others);
        state[r] = up;
        diagonal = left;
    }
}

/// Scores of the windows that start in the rows of `memory.above`.
///
/// F(j) is computed side by side with B(j + 1): each is a chain of dependent operations, two keep the processor busy.
#[inline(always)]
fn pairs<S: Simd, const M: usize>(
    setting: Setting<S>,
    steps: usize,
    memory: &mut Memory<S, M>,
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

/// The next column of F(j): first cells in column j − l.
#[inline(always)]
fn advance_front<S: Simd, const M: usize>(
    setting: Setting<S>,
    k: &Column<S, M>,
    l: usize,
    front: &mut Column<S, M>,
) {
    let edge = if l == 0 { setting.front } else { setting.zero };
    advance::<S, M, true>(setting, setting.rows, k, front, edge);
}

/// The next column of B(j): last cells in column j + q.
#[inline(always)]
fn advance_back<S: Simd, const M: usize>(
    setting: Setting<S>,
    k: &Column<S, M>,
    q: usize,
    back: &mut Column<S, M>,
    backs: &mut [Column<S, M>; M],
) {
    // Row c is left downwards from m itself or diagonally.
    let edge = if q < 2 { setting.back } else { setting.zero };
    advance::<S, M, false>(setting, setting.rows - 1, k, back, edge);
    backs[q] = *back;
}

/// Adds F(j) B(j) for the pairs whose window of the pieces begins in column j − l to their sums, and compares what is complete.
#[inline(always)]
fn add_products<S: Simd, const M: usize>(
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
        // Windows that end in row c end in m: nothing lies behind it.
        sum[rows - 1] = simd.mul(front[rows - 1], setting.back);
        compare(setting, window, sum, hits);
    }
}

/// Offers the scores of one window of each piece that reach their threshold.
#[inline(always)]
fn compare<S: Simd, const M: usize>(
    setting: Setting<S>,
    window: usize,
    sum: &Column<S, M>,
    hits: &mut Hits<'_>,
) {
    let Setting {
        simd, rows, part, ..
    } = setting;
    let weight = simd.load(&hits.weights[window], part);
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
fn last_window<S: Simd, const M: usize>(
    setting: Setting<S>,
    memory: &Memory<S, M>,
    hits: &mut Hits<'_>,
) {
    let Setting { simd, rows, .. } = setting;
    for window in 0..hits.weights.len() {
        let mut state = [setting.zero; M];
        for l in 0..rows {
            let edge = if l == 0 { setting.front } else { setting.zero };
            let k = &memory.above[window + rows - 1 - l];
            advance::<S, M, true>(setting, rows, k, &mut state, edge);
        }
        state[rows - 1] = simd.mul(state[rows - 1], setting.back);
        compare(setting, window, &state, hits);
    }
}

/// The selections of a query and what a score must reach to be of interest to those of the current block.
struct Hits<'a> {
    selections: &'a mut [Selection],
    /// Windows that start before the block.
    first: usize,
    /// Entry k is for the window that starts k rows before the end of the block.
    thresholds: Vec<f32>,
    /// Weights of the windows of the group, and the first window of each of its lanes.
    weights: &'a [Lanes],
    first_windows: &'a [usize; LANES],
}

impl<'a> Hits<'a> {
    fn new(selections: &'a mut [Selection], rows: usize) -> Self {
        Self {
            selections,
            first: 0,
            thresholds: vec![f32::INFINITY; rows],
            weights: &[],
            first_windows: &[0; LANES],
        }
    }

    /// Turns to the block whose first row starts window `first`.
    #[inline]
    fn open(&mut self, first: usize) {
        self.first = first;
        let rows = self.thresholds.len();
        for k in 0..rows {
            self.thresholds[k] = match self.selections.get(first + rows - 1 - k) {
                Some(selection) => least(selection),
                None => f32::INFINITY,
            };
        }
    }

    /// Takes the scores of one window of each piece, for each k those that `reached` has a bit for.
    #[inline(never)]
    fn offer(&mut self, reached: &[u32], scores: &[Lanes], first_lane: usize, window: usize) {
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

/// At least the smallest normal number: the score 0 of a place without a window is of no interest.
fn least(selection: &Selection) -> f32 {
    selection.threshold().max(f32::MIN_POSITIVE)
}
