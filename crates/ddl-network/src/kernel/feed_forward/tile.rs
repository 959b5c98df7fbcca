//! The forward pass of a few rows.

use super::block::{Block, BlockRows, tile_mut};
use super::dropout::UnitDecisions;
use super::hidden::activate;
use super::product::add_product;
use super::weights::BlockWeights;
use ddl_simd::{Simd, TiledKernel};

pub(super) struct Tile<'a> {
    pub(super) weights: &'a BlockWeights,
    pub(super) decisions: Option<&'a UnitDecisions>,
    pub(super) first: usize,
    pub(super) x: &'a BlockRows,
    pub(super) y: &'a mut BlockRows,
}

impl TiledKernel for Tile<'_> {
    #[inline(always)]
    fn run<S: Simd, const R: usize, const V: usize>(self, simd: S) {
        let Self {
            weights,
            decisions,
            first,
            x,
            y,
        } = self;
        for column in 0..weights.columns {
            y.column_mut(column).fill(weights.b2[column]);
        }
        let mut hidden = [Block::ZERO; R];
        for unit in 0..weights.units {
            let of_unit = weights.unit(unit);
            for row in (0..x.rows()).step_by(R) {
                activate::<S, R, V>(simd, of_unit, x, row, &mut hidden);
                if let Some(decisions) = decisions {
                    decisions.apply(simd, &mut hidden, first + row, unit);
                }
                for column in 0..weights.columns {
                    let y = tile_mut(y.column_mut(column), row);
                    add_product::<S, R, V>(simd, y, &hidden, of_unit.w2_transposed(column));
                }
            }
        }
    }
}
