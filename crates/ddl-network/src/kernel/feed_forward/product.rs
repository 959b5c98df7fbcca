//! Products of small matrices, with the result in registers.

use super::block::{BLOCK, Block, PARTS, Panel, tile_mut};
use crate::kernel::affine::{UNROLLED, add_outer_product};
use ddl_simd::{LANES, Simd, Tile};

/// sum + A B for R rows of A and V parts of the columns of B, beginning with part `part`.
/// A `[R, 32]`, B `[32, 32]`.
#[inline(always)]
pub(super) fn multiply<S: Simd, const R: usize, const V: usize>(
    simd: S,
    mut sum: Tile<S, R, V>,
    a: &[Block; R],
    b: &Panel,
    part: usize,
) -> Tile<S, R, V> {
    for group in 0..BLOCK / UNROLLED {
        for t in group * UNROLLED..(group + 1) * UNROLLED {
            let mut of_b = [simd.splat(0.0); V];
            for v in 0..V {
                of_b[v] = simd.load(b[t].part(part + v));
            }
            for r in 0..R {
                let of_a = simd.splat(a[r].0[t]);
                for v in 0..V {
                    sum[r][v] = simd.mul_add(of_a, of_b[v], sum[r][v]);
                }
            }
        }
    }
    sum
}

/// A^T B for R columns of A, beginning with column `first`, and V parts of the columns of B, beginning with part
/// `part`. A `[t, 32]`, B `[t, 32]`.
#[inline(always)]
pub(super) fn multiply_transposed<S: Simd, const R: usize, const V: usize>(
    simd: S,
    a: &[Block],
    first: usize,
    b: &[Block],
    part: usize,
) -> Tile<S, R, V> {
    assert!(first + R <= BLOCK);
    let mut sum = [[simd.splat(0.0); V]; R];
    let (eights, rest) = a.as_chunks::<UNROLLED>();
    let (eights_of_b, rest_of_b) = b.as_chunks::<UNROLLED>();
    for (a, b) in eights.iter().zip(eights_of_b) {
        for t in 0..UNROLLED {
            sum = add_outer_product(simd, sum, &a[t].0, first, &b[t].0, part * LANES);
        }
    }
    for (a, b) in rest.iter().zip(rest_of_b) {
        sum = add_outer_product(simd, sum, &a.0, first, &b.0, part * LANES);
    }
    sum
}

#[inline(always)]
pub(super) fn load_tile<S: Simd, const R: usize, const V: usize>(
    simd: S,
    from: &[Block; R],
    part: usize,
) -> Tile<S, R, V> {
    let mut tile = [[simd.splat(0.0); V]; R];
    for r in 0..R {
        for v in 0..V {
            tile[r][v] = simd.load(from[r].part(part + v));
        }
    }
    tile
}

#[inline(always)]
pub(super) fn store_tile<S: Simd, const R: usize, const V: usize>(
    simd: S,
    tile: &Tile<S, R, V>,
    into: &mut [Block; R],
    part: usize,
) {
    for r in 0..R {
        for v in 0..V {
            simd.store(tile[r][v], into[r].part_mut(part + v));
        }
    }
}

/// sum + A B, with the sum in memory.
/// `sum` and A `[R, 32]`, B `[32, 32]`.
#[inline(always)]
pub(super) fn add_product<S: Simd, const R: usize, const V: usize>(
    simd: S,
    sum: &mut [Block; R],
    a: &[Block; R],
    b: &Panel,
) {
    for part in (0..PARTS).step_by(V) {
        let tile = load_tile::<S, R, V>(simd, sum, part);
        let tile = multiply(simd, tile, a, b, part);
        store_tile(simd, &tile, sum, part);
    }
}

/// sum + A^T B, with the sum in memory.
/// `sum` `[32, 32]`, A and B `[t, 32]`.
#[inline(always)]
pub(super) fn add_transposed_product<S: Simd, const R: usize, const V: usize>(
    simd: S,
    sum: &mut Panel,
    a: &[Block],
    b: &[Block],
) {
    for first in (0..BLOCK).step_by(R) {
        let sum = tile_mut::<R>(sum, first);
        for part in (0..PARTS).step_by(V) {
            let mut tile: Tile<S, R, V> = multiply_transposed(simd, a, first, b, part);
            for r in 0..R {
                for v in 0..V {
                    // Added at the end, because partial sums have smaller rounding errors than one long sum.
                    tile[r][v] = simd.add(tile[r][v], simd.load(sum[r].part(part + v)));
                }
            }
            store_tile(simd, &tile, sum, part);
        }
    }
}

#[inline(always)]
pub(super) fn sum_of_rows<S: Simd, const V: usize>(simd: S, rows: &[Block]) -> Block {
    let mut result = Block::ZERO;
    for part in (0..PARTS).step_by(V) {
        let mut sum = [simd.splat(0.0); V];
        for row in rows {
            for v in 0..V {
                sum[v] = simd.add(sum[v], simd.load(row.part(part + v)));
            }
        }
        for v in 0..V {
            simd.store(sum[v], result.part_mut(part + v));
        }
    }
    result
}
