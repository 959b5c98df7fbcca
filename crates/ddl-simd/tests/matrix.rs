//! Products of matrices on a matrix unit, compared with sums in `f64`.

use ddl_simd::{
    BLOCK, Block, Dispatch, InstructionSet, LeftFactor, MatrixDispatch, MatrixKernel, MatrixUnit, Panel, RightFactor,
    Simd, Start,
};
use proptest::prelude::*;

fn unit() -> Option<MatrixDispatch> {
    Dispatch::new(InstructionSet::Amx).and_then(Dispatch::matrix_unit)
}

struct Product<'a> {
    start: Option<&'a Block>,
    a: &'a Panel,
    b: &'a Panel,
    sum: &'a mut Panel,
}

impl MatrixKernel for Product<'_> {
    #[inline(always)]
    fn run<U: MatrixUnit>(self, unit: U) {
        let half = |row: &Block, half| unit.pieces(unit.simd().load(row.part(half)));
        let (mut left, mut right) = (LeftFactor::ZERO, RightFactor::ZERO);
        for (row, numbers) in self.a.iter().enumerate() {
            left.set_row(unit, row, [&half(numbers, 0), &half(numbers, 1)]);
        }
        for (pair, [even, odd]) in self.b.as_chunks().0.iter().enumerate() {
            for h in 0..2 {
                right.set_rows(unit, pair, h, [&half(even, h), &half(odd, h)]);
            }
        }
        unit.start(self.start.map_or(Start::Panel(self.sum), Start::Row));
        unit.add_product(&left, &right);
        unit.store(self.sum);
    }
}

fn panel(largest: i32) -> impl Strategy<Value = Panel> {
    let number = (-1.0_f32..1.0, -largest..largest).prop_map(|(number, exponent)| number * 2_f32.powi(exponent));
    proptest::collection::vec(number, BLOCK * BLOCK).prop_map(|numbers| {
        let mut panel = Block::ZERO_PANEL;
        for (row, numbers) in panel.iter_mut().zip(numbers.chunks(BLOCK)) {
            *row = Block::padded(numbers);
        }
        panel
    })
}

proptest! {
    #[test]
    fn the_error_is_that_of_f32(a in panel(20), b in panel(20), start in panel(20), one_row: bool) {
        let Some(unit) = unit() else { return Ok(()) };
        let mut sum = start;
        let row = one_row.then_some(&start[0]);
        unit.run(Product { start: row, a: &a, b: &b, sum: &mut sum });
        for (i, j) in (0..BLOCK * BLOCK).map(|at| (at / BLOCK, at % BLOCK)) {
            let first = f64::from(if one_row { start[0].0[j] } else { start[i].0[j] });
            let terms = (0..BLOCK).map(|k| f64::from(a[i].0[k]) * f64::from(b[k].0[j]));
            let (exact, size) = terms.fold((first, 0.0), |(sum, size), term| (sum + term, size + term.abs()));
            let bound = 2_f64.powi(-24) * (20.0 * size + 6.0 * (size + first.abs()));
            prop_assert!((f64::from(sum[i].0[j]) - exact).abs() <= bound, "{} for {exact}", sum[i].0[j]);
        }
    }

    /// One number of a row and one of a column that are not 0: the largest error of a single product.
    #[test]
    fn a_single_product_is_off_by_a_unit_in_the_last_place(a in -2.0_f32..2.0, b in -2.0_f32..2.0, at in 0..BLOCK) {
        let Some(unit) = unit() else { return Ok(()) };
        let [mut left, mut right, mut sum] = [Block::ZERO_PANEL; 3];
        left[BLOCK - 1].0[at] = a;
        right[at].0[3] = b;
        unit.run(Product { start: Some(&Block::ZERO), a: &left, b: &right, sum: &mut sum });
        let exact = f64::from(a) * f64::from(b);
        prop_assert!((f64::from(sum[BLOCK - 1].0[3]) - exact).abs() <= 2.02 * 2_f64.powi(-24) * exact.abs() + 1e-37);
        sum[BLOCK - 1].0[3] = 0.0;
        prop_assert_eq!(sum, Block::ZERO_PANEL);
    }
}

#[test]
fn what_is_not_a_number_stays_in_its_row() {
    let Some(unit) = unit() else { return };
    for nan in [
        f32::NAN,
        f32::INFINITY,
        f32::from_bits(0x7fff_ffff),
        f32::from_bits(0x7f80_0001),
    ] {
        let [mut a, b] = [[Block([1.0; BLOCK]); BLOCK]; 2];
        a[5].0[7] = nan;
        let mut sum = a;
        unit.run(Product {
            start: None,
            a: &a,
            b: &b,
            sum: &mut sum,
        });
        for (row, numbers) in sum.iter().enumerate() {
            assert!(
                numbers.0.iter().all(|number| number.is_finite() == (row != 5)),
                "{row}: {numbers:?}"
            );
        }
    }
}
