//! The forward pass with products of bf16 numbers and sums in `f32`: an instruction has twice as many multiplications.
//! It multiplies two numbers of a row of A with two rows of B. So A is stored in pairs of neighbours in a row, and B in
//! pairs of neighbours in a column.

use super::block::{BLOCK, Block, PARTS, Panel, tile_mut};
use super::product::{load_tile, store_tile};
use super::tile::Tile;
use super::weights::BlockWeights;
use ddl_simd::{self, LANES, PairDispatch, PairKernel, Pairs, Simd};

const PAIRS: usize = BLOCK / 2;

#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
struct PairedRow([u32; PAIRS]);

#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
struct TwoRows([u32; BLOCK]);

type PairPanel = [TwoRows; PAIRS];

impl PairedRow {
    const ZERO: Self = Self([0; PAIRS]);

    #[inline(always)]
    fn round<P: Pairs>(&mut self, pairs: P, row: &Block) {
        let simd = pairs.simd();
        let words = pairs.neighbours(simd.load(row.part(0)), simd.load(row.part(1)));
        pairs.store(words, &mut self.0);
    }
}

impl TwoRows {
    const ZERO: Self = Self([0; BLOCK]);

    #[inline(always)]
    fn part(&self, part: usize) -> &[u32; LANES] {
        &self.0.as_chunks().0[part]
    }

    #[inline(always)]
    fn round<P: Pairs>(&mut self, pairs: P, rows: &[Block; 2]) {
        let simd = pairs.simd();
        for part in 0..PARTS {
            let [first, second] = [simd.load(rows[0].part(part)), simd.load(rows[1].part(part))];
            let words = pairs.across(first, second);
            pairs.store(words, &mut self.0.as_chunks_mut().0[part]);
        }
    }
}

#[derive(Clone, Debug)]
pub(super) struct Squares {
    w1_transposed: Vec<PairPanel>,
    w2_transposed: Vec<PairPanel>,
}

impl Squares {
    pub(super) fn round(weights: &BlockWeights, dispatch: PairDispatch) -> Self {
        let round = |panels: &[Panel]| {
            let mut rounded = vec![[TwoRows::ZERO; PAIRS]; panels.len()];
            dispatch.run(Round {
                from: panels.as_flattened(),
                into: rounded.as_flattened_mut(),
            });
            rounded
        };
        Self {
            w1_transposed: round(&weights.w1_transposed),
            w2_transposed: round(&weights.w2_transposed),
        }
    }
}

struct Round<'a> {
    from: &'a [Block],
    into: &'a mut [TwoRows],
}

impl PairKernel for Round<'_> {
    #[inline(always)]
    fn run<P: Pairs>(self, pairs: P) {
        for (rows, into) in self.from.as_chunks().0.iter().zip(self.into) {
            into.round(pairs, rows);
        }
    }
}

pub(super) struct PairForward<'a> {
    pub(super) tile: Tile<'a>,
    pub(super) squares: &'a Squares,
}

impl PairKernel for PairForward<'_> {
    #[inline(always)]
    fn run<P: Pairs>(self, pairs: P) {
        let Self {
            tile:
                Tile {
                    weights,
                    decisions,
                    first,
                    x,
                    y,
                },
            squares,
        } = self;
        let columns = weights.columns;
        // All blocks of the first rows, then those of the next rows, and so on.
        let mut rounded_x = vec![[PairedRow::ZERO; ROWS]; columns * x.rows() / ROWS];
        for (tile, rounded) in rounded_x.iter_mut().enumerate() {
            let (row, column) = (tile / columns * ROWS, tile % columns);
            for r in 0..ROWS {
                rounded[r].round(pairs, &x.column(column)[row + r]);
            }
        }
        for column in 0..columns {
            y.column_mut(column).fill(weights.b2[column]);
        }
        let mut hidden = [Block::ZERO; ROWS];
        let mut rounded = [PairedRow::ZERO; ROWS];
        for unit in 0..weights.units {
            let b1 = weights.unit(unit).b1();
            let of_unit = unit * columns..(unit + 1) * columns;
            let w1_transposed = &squares.w1_transposed[of_unit.clone()];
            let w2_transposed = &squares.w2_transposed[of_unit];
            for (tile, x) in rounded_x.chunks_exact(columns).enumerate() {
                let row = tile * ROWS;
                activate(pairs, b1, w1_transposed, x, &mut hidden);
                if let Some(decisions) = decisions {
                    decisions.apply(pairs.simd(), &mut hidden, first + row, unit);
                }
                for r in 0..ROWS {
                    rounded[r].round(pairs, &hidden[r]);
                }
                for (column, w2) in w2_transposed.iter().enumerate() {
                    let y = tile_mut(y.column_mut(column), row);
                    add_product(pairs, y, &rounded, w2);
                }
            }
        }
    }
}

/// relu(W1 x + b1) for a block of units and some rows, in `f32`.
#[inline(always)]
fn activate<P: Pairs>(
    pairs: P,
    b1: &Block,
    w1_transposed: &[PairPanel],
    x: &[[PairedRow; ROWS]],
    hidden: &mut [Block; ROWS],
) {
    let simd = pairs.simd();
    let b1 = [simd.load(b1.part(0)), simd.load(b1.part(1))];
    let mut sum: Sums<P> = [b1; ROWS];
    for (x, w1) in x.iter().zip(w1_transposed) {
        sum = multiply(pairs, sum, x, w1);
    }
    for r in 0..ROWS {
        for v in 0..PARTS {
            sum[r][v] = simd.max(simd.splat(0.0), sum[r][v]);
        }
    }
    store_tile(simd, &sum, hidden, 0);
}

/// Rows of a [`Sums`]. With all columns of a block they fill 16 of the 32 registers of AVX-512. Two operations in a
/// cycle, each with a latency of six cycles, need at least twelve.
const ROWS: usize = 8;

type Sums<P> = ddl_simd::Tile<<P as Pairs>::Simd, ROWS, PARTS>;

/// sum + A B.
#[inline(always)]
fn multiply<P: Pairs>(pairs: P, mut sum: Sums<P>, a: &[PairedRow; ROWS], b: &PairPanel) -> Sums<P> {
    for t in 0..PAIRS {
        let of_b = [pairs.load(b[t].part(0)), pairs.load(b[t].part(1))];
        for r in 0..ROWS {
            let of_a = pairs.splat(a[r].0[t]);
            for v in 0..PARTS {
                sum[r][v] = pairs.dot(of_a, of_b[v], sum[r][v]);
            }
        }
    }
    sum
}

#[inline(always)]
fn add_product<P: Pairs>(pairs: P, sum: &mut [Block; ROWS], a: &[PairedRow; ROWS], b: &PairPanel) {
    let tile = load_tile(pairs.simd(), sum, 0);
    let tile = multiply(pairs, tile, a, b);
    store_tile(pairs.simd(), &tile, sum, 0);
}
