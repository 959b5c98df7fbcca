//! Comparison with the formula in double precision.

use crate::kernel::heads::AttentionKernel;
use crate::kernel::heads::HEAD_WIDTH;
use crate::kernel::spatial_attention::dropout::WeightDecisions;
use crate::kernel::spatial_attention::queries::TWOS_AT_ONCE;
use crate::kernel::tests::attention::attention;
use crate::kernel::tests::numbers::{SeededNumbers, assert_close, lists};
use crate::kernel::{Dropout, Scenes};
use ddl_simd::{Dispatch, InstructionSet};
use proptest::prelude::*;

struct SceneCase {
    heads: usize,
    sizes: Vec<usize>,
    visible: Vec<bool>,
    entries: usize,
    dropout: Option<Dropout>,
    /// Queries, keys and values.
    inputs: [Vec<f32>; 3],
    gradient: Vec<f32>,
}

impl SceneCase {
    fn new(seed: u64, heads: usize, sizes: &[usize], (entries, frames): (usize, usize), bound: f32) -> Self {
        let mut numbers = SeededNumbers::seeded(seed);
        let pedestrians: usize = sizes.iter().sum();
        let rows = entries * pedestrians * heads * HEAD_WIDTH;
        Self {
            heads,
            sizes: sizes.to_vec(),
            visible: numbers.visible(sizes, frames),
            entries,
            dropout: None,
            inputs: [0; 3].map(|_| numbers.even(rows, bound)),
            gradient: numbers.even(rows, 1.0),
        }
    }

    fn run(&self, set: InstructionSet) -> (Vec<f32>, Vec<f32>) {
        let mut attention = AttentionKernel::new(self.heads);
        attention.dispatch = Dispatch::new(set).unwrap();
        let scenes = Scenes::new(&self.sizes, lists(&self.sizes, &self.visible));
        let frames = scenes.throughout();
        let attended = attention.spatial_forward(self.inputs(), frames, self.dropout, true);
        let mut gradients = [0; 3].map(|_| vec![f32::NAN; self.gradient.len()]);
        attention.spatial_backward(
            self.inputs(),
            frames,
            self.dropout,
            &attended,
            &self.gradient,
            gradients.each_mut().map(|gradient| &mut gradient[..]),
        );
        (attended.mixed.to_vec(), gradients.concat())
    }

    fn inputs(&self) -> [&[f32]; 3] {
        self.inputs.each_ref().map(|input| &input[..])
    }

    fn expected(&self) -> (Vec<f64>, Vec<f64>) {
        let pedestrians: usize = self.sizes.iter().sum();
        let lists = lists(&self.sizes, &self.visible);
        let mut firsts = Vec::new();
        for &size in &self.sizes {
            firsts.extend(std::iter::repeat_n(firsts.len(), size));
        }
        let seen = |row: usize| {
            let first = row / pedestrians * pedestrians + firsts[row % pedestrians];
            lists[row % lists.len()].iter().map(|&j| first + j as usize).collect()
        };
        let seen: Vec<Vec<usize>> = (0..self.entries * pedestrians).map(seen).collect();
        let decisions = self.dropout.and_then(WeightDecisions::new);
        let factor = |row: usize, key: usize, head| {
            let factor = |decisions: WeightDecisions| {
                decisions.factor(row / pedestrians, row % pedestrians, key % pedestrians, head)
            };
            decisions.map_or(1.0, |decisions| f64::from(factor(decisions)))
        };
        let (mixed, gradients) = attention(self.inputs(), &self.gradient, self.heads, &seen, factor);
        (mixed, gradients.concat())
    }

    fn check(&self, tolerance: f64) {
        let (mixed, gradient) = self.expected();
        for set in InstructionSet::available() {
            let (of_mixed, of_gradient) = self.run(set);
            let name = |what| format!("{set:?}, {:?} of {:?}: {what}", self.heads, self.sizes);
            assert_close(&name("mixed"), &of_mixed, &mixed, tolerance);
            assert_close(&name("gradient"), &of_gradient, &gradient, tolerance);
        }
    }
}

const STAR: usize = 8;

/// The heads of STAR, parts of a group, and several groups.
fn heads() -> impl Strategy<Value = usize> {
    prop_oneof![Just(STAR), prop::sample::select(vec![1, 3, 12, 16]),]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(128))]

    #[test]
    fn agrees_with_the_formula(
        (heads, sizes) in (heads(), prop::collection::vec(1_usize..24, 1..5)),
        (entries, shared, seed) in (1_usize..4, any::<bool>(), any::<u64>()),
        p in prop::option::of(0.0..0.9),
        bound in 0.1_f32..3.0,
    ) {
        let frames = if shared { 1 } else { entries };
        let mut case = SceneCase::new(seed, heads, &sizes, (entries, frames), bound);
        case.dropout = p.map(|p| Dropout { p, seed });
        case.check(5e-6);
    }
}

#[test]
fn agrees_in_large_scenes() {
    SceneCase::new(21, STAR, &[2 * TWOS_AT_ONCE + 21], (2, 1), 1.5).check(5e-6);
}

/// The keys of the second block of queries begin at 507: in the middle of the scene, and at an odd place.
#[test]
fn agrees_where_a_block_reads_some_of_the_keys() {
    let size = 2 * TWOS_AT_ONCE + 21;
    for heads in [STAR, 12] {
        let mut case = SceneCase::new(22, heads, &[size], (1, 1), 1.5);
        for (i, row) in case.visible.chunks_exact_mut(size).enumerate() {
            for (j, visible) in row.iter_mut().enumerate() {
                *visible = i.abs_diff(j) <= 5;
            }
        }
        case.check(5e-6);
    }
}

/// A score 100 below the largest, in log2 units, has the weight 0.
#[test]
fn a_vanishing_weight_is_zero() {
    let mut case = SceneCase::new(8, STAR, &[2], (1, 1), 1.0);
    case.visible.fill(true);
    let row = |number: f32| [number; 32];
    let keys = [row(0.0), row(-50.0 * std::f32::consts::LN_2)];
    case.inputs = [[row(1.0); 2], keys, [row(3.0), row(100_f32.exp2())]].map(|rows| rows.concat());
    for set in InstructionSet::available() {
        let (mixed, _) = case.run(set);
        assert!(mixed.iter().all(|number| number.to_bits() == 3_f32.to_bits()), "{set:?}: {mixed:?}");
    }
}

/// Scores of several hundred give weights of almost 0 and 1. Sums of powers would overflow if the largest score were
/// not subtracted. Scores have rounding errors of 3e-5, and so have the weights.
#[test]
fn bears_big_scores() {
    let case = SceneCase::new(6, STAR, &[9, 30], (2, 1), 20.0);
    case.check(2e-4);
    let mut same = SceneCase::new(7, STAR, &[6], (1, 1), 1.0);
    for input in &mut same.inputs[..2] {
        input.fill(1e4); // scores of 2e8, all equal
    }
    same.visible.fill(true);
    let (mixed, _) = same.run(Dispatch::detect().instruction_set());
    for number in 0..32 {
        let mean = (0..6).map(|pedestrian: usize| same.inputs[2][pedestrian * 32 + number]).sum::<f32>() / 6.0;
        for row in mixed.chunks_exact(32) {
            assert!((row[number] - mean).abs() < 1e-6, "{}: {mean}", row[number]);
        }
    }
}
