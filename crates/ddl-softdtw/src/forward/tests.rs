//! Both representations of R, and all instruction sets, give the same bits.

use proptest::prelude::*;

use ddl_simd::{Dispatch, InstructionSet, Kernel, Simd};

use crate::grid::{Grid, Recursion, Slanted};
use crate::weight::{Plain, Scaled, Total};

/// R of the last cell as a number with a separate exponent, and as a plain number from 2^start.
struct Totals<'a>(&'a Grid<'a, 2>, f64, &'a mut [Total; 2]);

impl Kernel for Totals<'_> {
    #[inline]
    fn run<S: Simd>(self, simd: S) {
        let Self(grid, start, totals) = self;
        let columns = Slanted::of(grid.columns);
        totals[0] = grid.forward::<S, Scaled, 2, false>(simd, 0.0, &columns, &mut Vec::new());
        totals[1] = grid.forward::<S, Plain, 1, false>(simd, start, &columns, &mut Vec::new());
    }
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn both_kinds_of_weight_give_the_same_bits(
        x in prop::collection::vec(prop::array::uniform2(-1.0..1.0_f64), 1..70),
        y in prop::collection::vec(prop::array::uniform2(-1.0..1.0_f64), 1..70),
        gamma in -2.7..3.0_f64,
    ) {
        let grid = Grid { rows: &x, columns: &y, gamma: 10.0_f64.powf(gamma) };
        match grid.recursion() {
            Recursion::Plain { start } => {
                let mut totals = [(0.0, 0.0); 2];
                Dispatch::detect().run(Totals(&grid, start, &mut totals));
                prop_assert!((1.0..2.0).contains(&totals[0].0));
                prop_assert_eq!(totals[0], totals[1]);
            }
            // The largest squared distance is 8.
            Recursion::Scaled => prop_assert!(8.0 * grid.scale() * x.len().max(y.len()) as f64 > 1000.0),
            Recursion::LogDomain => prop_assert!(false, "costs far below the limit"),
        }
    }

    #[test]
    fn every_instruction_set_gives_the_same_bits(
        x in prop::collection::vec(prop::array::uniform3(-3.0..3.0_f64), 1..40),
        y in prop::collection::vec(prop::array::uniform3(-3.0..3.0_f64), 1..40),
        gamma in 0.01..10.0_f64,
    ) {
        let grid = Grid { rows: &x, columns: &y, gamma };
        let results = |set| {
            let dispatch = Dispatch::new(set).expect("available");
            (grid.value_with(dispatch), grid.value_and_gradient_with(dispatch))
        };
        let portable = results(InstructionSet::Portable);
        prop_assert_eq!(portable.0.to_bits(), portable.1.0.to_bits());
        for set in InstructionSet::available() {
            prop_assert_eq!(&results(set), &portable);
        }
    }
}
