//! Comparison with the formula in double precision, and decisions of dropout.

use crate::kernel::add_norm::{AddNorm, Decisions, Normal};
use crate::kernel::dropout::Dropout;
use crate::kernel::tests::chance::Decided;
use crate::kernel::tests::numbers::{SeededNumbers, assert_close};
use ddl_simd::{Dispatch, InstructionSet, Kernel, Simd};
use proptest::prelude::*;

struct Both<'a> {
    norm: &'a AddNorm,
    inputs: [&'a [f32]; 2],
    gy: &'a [f32],
    decisions: Option<Decisions>,
    results: &'a mut NormResults,
}

struct NormResults {
    normal: Vec<f32>,
    scales: Vec<f32>,
    y: Vec<f32>,
    gx: Vec<f32>,
    gt: Vec<f32>,
    weight: Vec<f32>,
    bias: Vec<f32>,
}

impl Kernel for Both<'_> {
    #[inline(always)]
    fn run<S: Simd>(self, simd: S) {
        let results = self.results;
        let decisions = self.decisions.map(|decisions| (decisions, 5));
        let mut normal = Normal { numbers: &mut results.normal, scales: &mut results.scales };
        self.norm.forward(simd, self.inputs, decisions, &mut normal, &mut results.y);
        self.norm.backward(
            simd,
            [&results.normal, &results.scales],
            self.gy,
            decisions,
            [&mut results.gx, &mut results.gt],
            [&mut results.weight, &mut results.bias],
        );
    }
}

struct NormCase {
    width: usize,
    x: Vec<f32>,
    t: Vec<f32>,
    gy: Vec<f32>,
    weight: Vec<f32>,
    bias: Vec<f32>,
}

impl NormCase {
    fn new(seed: u64, width: usize, rows: usize) -> Self {
        let mut numbers = SeededNumbers::seeded(seed);
        Self {
            width,
            x: numbers.even(rows * width, 2.0),
            t: numbers.even(rows * width, 1.0),
            gy: numbers.even(rows * width, 1.0),
            weight: numbers.even(width, 1.5),
            bias: numbers.even(width, 1.0),
        }
    }

    fn run(&self, set: InstructionSet, dropout: Option<Dropout>) -> NormResults {
        let mut norm = AddNorm::new(self.width);
        norm.update(&self.weight, &self.bias);
        let zeros = || vec![0.0; self.x.len()];
        let mut results = NormResults {
            normal: zeros(),
            scales: vec![0.0; self.x.len() / self.width],
            y: zeros(),
            gx: zeros(),
            gt: zeros(),
            weight: vec![0.25; self.width],
            bias: vec![0.25; self.width],
        };
        Dispatch::new(set).unwrap().run(Both {
            norm: &norm,
            inputs: [&self.x, &self.t],
            gy: &self.gy,
            decisions: dropout.and_then(Decisions::new),
            results: &mut results,
        });
        results
    }

    /// By the definition, with the dropout `factors` of t: y, gx, and the gradients of weight and bias.
    fn expected(&self, factors: &[f64]) -> [Vec<f64>; 4] {
        let n = self.width as f64;
        let (mut y, mut gx) = (Vec::new(), Vec::new());
        let (mut of_weight, mut of_bias) = (vec![0.25; self.width], vec![0.25; self.width]);
        for first in (0..self.x.len()).step_by(self.width) {
            let sum = |i: usize| f64::from(self.x[first + i]) + factors[first + i] * f64::from(self.t[first + i]);
            let sums: Vec<f64> = (0..self.width).map(sum).collect();
            let mean = sums.iter().sum::<f64>() / n;
            let variance = sums.iter().map(|s| (s - mean).powi(2)).sum::<f64>() / n;
            let deviation = (variance + 1e-5).sqrt();
            let normal: Vec<f64> = sums.iter().map(|s| (s - mean) / deviation).collect();
            let g: Vec<f64> =
                (0..self.width).map(|i| f64::from(self.gy[first + i]) * f64::from(self.weight[i])).collect();
            let g_mean = g.iter().sum::<f64>() / n;
            let along = g.iter().zip(&normal).map(|(g, x)| g * x).sum::<f64>() / n;
            for i in 0..self.width {
                let gy = f64::from(self.gy[first + i]);
                y.push(normal[i] * f64::from(self.weight[i]) + f64::from(self.bias[i]));
                gx.push((g[i] - g_mean - normal[i] * along) / deviation);
                of_weight[i] += gy * normal[i];
                of_bias[i] += gy;
            }
        }
        [y, gx, of_weight, of_bias]
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn rows_are_normalised_and_their_gradients_are_those_of_the_formula(
        // With a width of 2 the gradient is almost 0 for any numbers, so that only rounding would be compared.
        width in 3..70_usize,
        rows in 0..12_usize,
        p in prop_oneof![Just(0.0), 0.05..0.9],
        seed in any::<u64>(),
    ) {
        let case = NormCase::new(seed, width, rows);
        for set in InstructionSet::available() {
            let dropout = Dropout { p, seed };
            let results = case.run(set, Some(dropout));
            // The gradient of t shows the decisions.
            let factors: Vec<f64> = results.gx.iter().zip(&results.gt)
                .map(|(gx, gt)| if *gt == 0.0 && *gx != 0.0 { 0.0 } else { 1.0 / (1.0 - p) })
                .collect();
            if p == 0.0 {
                prop_assert_eq!(&results.gx, &results.gt);
            }
            let [y, gx, weight, bias] = case.expected(&factors);
            // Rows of nearly equal numbers have a derivative of some hundreds, and errors in proportion.
            let tolerance = if width < 8 { 2e-3 } else { 2e-5 };
            assert_close("y", &results.y, &y, tolerance);
            assert_close("gx", &results.gx, &gx, tolerance);
            assert_close("weight", &results.weight, &weight, tolerance);
            assert_close("bias", &results.bias, &bias, tolerance);
        }
    }
}

#[test]
fn decisions_are_like_chance_and_the_same_for_every_instruction_set() {
    let (rows, width) = (3000, 40);
    let case = NormCase::new(1, width, rows);
    let dropped = |set| -> Vec<bool> {
        case.run(set, Some(Dropout { p: 0.1, seed: 3 })).gt.iter().map(|&gt| gt == 0.0).collect()
    };
    let first = dropped(InstructionSet::Portable);
    for set in InstructionSet::available() {
        assert!(dropped(set) == first, "{set:?}");
    }
    Decided::new(0.1, [rows, width], |row, column| first[row * width + column]).assert_like_chance();
}
