//! Comparison with the formula in double precision.

use crate::kernel::affine::Affine;
use crate::kernel::columns::{MatrixColumns, MatrixColumnsMut};
use crate::kernel::tests::numbers::{Numbers, assert_close, wide};
use ddl_simd::{Dispatch, InstructionSet, Simd, TiledKernel};
use proptest::prelude::*;

struct All<'a> {
    map: &'a Affine,
    x: MatrixColumns<'a>,
    gy: MatrixColumns<'a>,
    y: MatrixColumnsMut<'a>,
    gx: MatrixColumnsMut<'a>,
    gradients: [&'a mut [f32]; 2],
}

impl TiledKernel for All<'_> {
    #[inline(always)]
    fn run<S: Simd, const R: usize, const V: usize>(mut self, simd: S) {
        self.map.forward::<S, R, V>(simd, self.x, &mut self.y);
        self.map.backward::<S, R, V>(simd, self.gy, &mut self.gx, true);
        self.map.add_gradients::<S, R, V>(simd, self.x, self.gy, self.gradients);
    }
}

/// Adds Σ over t of a(i, t) b(t, j) to the present contents.
fn product(
    [rows, depth, columns]: [usize; 3],
    a: impl Fn(usize, usize) -> f64,
    b: impl Fn(usize, usize) -> f64,
    before: f64,
) -> Vec<f64> {
    let entry = |i, j| before + (0..depth).map(|t| a(i, t) * b(t, j)).sum::<f64>();
    (0..rows)
        .flat_map(|i| (0..columns).map(move |j| (i, j)))
        .map(|(i, j)| entry(i, j))
        .collect()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn products_are_those_of_the_formula(
        inputs in 1..70_usize,
        outputs in 1..70_usize,
        rows in 0..30_usize,
        seed in any::<u64>(),
    ) {
        let mut numbers = Numbers(seed);
        let (weight, bias) = (numbers.even(outputs * inputs, 1.0), numbers.even(outputs, 1.0));
        let (x, gy) = (numbers.even(rows * inputs, 1.0), numbers.even(rows * outputs, 1.0));
        let mut map = Affine::new(inputs, outputs);
        map.update(&weight, &bias);
        let w = |o: usize, i: usize| f64::from(weight[o * inputs + i]);
        let at_x = |r: usize, i: usize| f64::from(x[r * inputs + i]);
        let at_gy = |r: usize, o: usize| f64::from(gy[r * outputs + o]);
        let mut expected_y = product([rows, inputs, outputs], at_x, |i, o| w(o, i), 0.0);
        for row in expected_y.chunks_exact_mut(outputs) {
            for (y, b) in row.iter_mut().zip(wide(&bias)) {
                *y += b;
            }
        }
        let expected_gx = product([rows, outputs, inputs], at_gy, w, 0.5);
        let expected_weight = product([outputs, rows, inputs], |o, r| at_gy(r, o), at_x, 0.25);
        let expected_bias = product([outputs, rows, 1], |o, r| at_gy(r, o), |_, _| 1.0, 0.25);
        for set in InstructionSet::available() {
            let (mut y, mut gx) = (vec![7.0; rows * outputs], vec![0.5; x.len()]);
            let (mut of_weight, mut of_bias) = (vec![0.25; weight.len()], vec![0.25; outputs]);
            Dispatch::new(set).unwrap().run(All {
                map: &map,
                x: MatrixColumns::whole(&x, inputs),
                gy: MatrixColumns::whole(&gy, outputs),
                y: MatrixColumnsMut::whole(&mut y, outputs),
                gx: MatrixColumnsMut::whole(&mut gx, inputs),
                gradients: [&mut of_weight, &mut of_bias],
            });
            assert_close("y", &y, &expected_y, 1e-5);
            assert_close("gx", &gx, &expected_gx, 1e-5);
            assert_close("weight", &of_weight, &expected_weight, 1e-5);
            assert_close("bias", &of_bias, &expected_bias, 1e-5);
        }
    }
}
