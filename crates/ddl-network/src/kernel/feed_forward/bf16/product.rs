//! Products of small matrices of pairs, the result in `f32` registers.

#![expect(clippy::inline_always, reason = "the lanes must stay in registers")]
#![expect(
    clippy::needless_range_loop,
    reason = "loops of a known count over registers, written as the matrices are"
)]

use super::{PAIRS, PairPanel, PairedRow};
use crate::kernel::feed_forward::block::{Block, PARTS};
use crate::kernel::feed_forward::product::{load_tile, store_tile};
use ddl_simd::{Pairs, Tile};

/// Rows of a [`Sums`]: with all columns of a block they fill half of the 32 registers of AVX-512, as two operations a cycle
/// of six cycles each need at least twelve.
pub(super) const ROWS: usize = 8;

/// Accumulators: all parts of some rows.
pub(super) type Sums<P> = Tile<<P as Pairs>::Simd, ROWS, PARTS>;

/// sum + A B.
#[inline(always)]
pub(super) fn multiply<P: Pairs>(
    pairs: P,
    mut sum: Sums<P>,
    a: &[PairedRow; ROWS],
    b: &PairPanel,
) -> Sums<P> {
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

/// sum + A B, the sum in memory.
#[inline(always)]
pub(super) fn add_product<P: Pairs>(
    pairs: P,
    sum: &mut [Block; ROWS],
    a: &[PairedRow; ROWS],
    b: &PairPanel,
) {
    let tile = load_tile(pairs.simd(), sum, 0);
    let tile = multiply(pairs, tile, a, b);
    store_tile(pairs.simd(), &tile, sum, 0);
}
