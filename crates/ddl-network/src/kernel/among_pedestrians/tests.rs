//! Against the formula in double precision.
#![allow(clippy::unwrap_used, reason = "a test may panic")]

mod laws;

use super::dropout::Decisions;
use super::{AmongPedestrians, Attended};
use crate::kernel::tests::attention::Attention;
use crate::kernel::tests::numbers::{Numbers, assert_close, wide};
use crate::kernel::{Dropout, Scenes};
use ddl_simd::InstructionSet;

/// Sizes of scenes, and everything else of a case.
pub(super) struct Case {
    pub(super) heads: (usize, usize),
    pub(super) sizes: Vec<usize>,
    pub(super) visible: Vec<bool>,
    pub(super) entries: usize,
    pub(super) dropout: Option<Dropout>,
    pub(super) qkv: Vec<f32>,
    pub(super) gradient: Vec<f32>,
}

impl Case {
    pub(super) fn new(
        seed: u64,
        heads: (usize, usize),
        sizes: &[usize],
        (entries, frames): (usize, usize),
        bound: f32,
    ) -> Self {
        let mut numbers = Numbers(seed);
        let pedestrians: usize = sizes.iter().sum();
        let rows = entries * pedestrians * heads.0 * heads.1;
        Self {
            heads,
            sizes: sizes.to_vec(),
            visible: numbers.visible(sizes, frames),
            entries,
            dropout: None,
            qkv: numbers.even(3 * rows, bound),
            gradient: numbers.even(rows, 1.0),
        }
    }

    /// Mixed values and the gradient of qkv.
    pub(super) fn run(&self, set: InstructionSet) -> (Vec<f32>, Vec<f32>) {
        let attention = AmongPedestrians::new(self.heads.0, self.heads.1);
        let attention = attention.with_instructions(set).unwrap();
        let scenes = Scenes::new(&self.sizes, &self.visible);
        let frames = scenes.throughout();
        let mut attended = Attended::default();
        attention.forward(&self.qkv, frames, self.dropout, &mut attended);
        let mut gradient = vec![f32::NAN; self.qkv.len()];
        attention.backward(
            &self.qkv,
            frames,
            self.dropout,
            &attended,
            &self.gradient,
            &mut gradient,
        );
        (attended.mixed().to_vec(), gradient)
    }

    /// The same by the formula.
    pub(super) fn expected(&self) -> (Vec<f64>, Vec<f64>) {
        let (heads, width) = self.heads;
        let pedestrians: usize = self.sizes.iter().sum();
        let (qkv, gradient) = (wide(&self.qkv), wide(&self.gradient));
        let at = |entry: usize, pedestrian: usize, part: usize, head: usize| {
            (((entry * pedestrians + pedestrian) * 3 + part) * heads + head) * width
        };
        let pairs: usize = self.sizes.iter().map(|size| size * size).sum();
        let frames = self.visible.len() / pairs;
        let decisions = self.dropout.and_then(Decisions::new);
        let mut mixed = vec![0.0; gradient.len()];
        let mut qkv_gradient = vec![0.0; qkv.len()];
        for entry in 0..self.entries {
            let mut visible = &self.visible[(entry % frames) * pairs..];
            let mut first = 0;
            for &size in &self.sizes {
                for i in first..first + size {
                    let (row, rest) = visible.split_at(size);
                    visible = rest;
                    let seen = (0..size).filter(|&j| row[j]).map(|j| first + j);
                    let seen: Vec<usize> = seen.collect();
                    for head in 0..heads {
                        let vector =
                            |pedestrian, part| &qkv[at(entry, pedestrian, part, head)..][..width];
                        let keys: Vec<&[f64]> = seen.iter().map(|&j| vector(j, 1)).collect();
                        let values: Vec<&[f64]> = seen.iter().map(|&j| vector(j, 2)).collect();
                        let factor = |&j: &usize| match decisions {
                            Some(decisions) => f64::from(decisions.factor(entry, i, j, head)),
                            None => 1.0,
                        };
                        let query = Attention {
                            query: vector(i, 0),
                            keys: &keys,
                            values: &values,
                            factors: &seen.iter().map(factor).collect::<Vec<_>>(),
                        };
                        let own = ((entry * pedestrians + i) * heads + head) * width;
                        mixed[own..own + width].copy_from_slice(&query.mixed());
                        let gradients = query.gradients(&gradient[own..own + width]);
                        let mut add = |pedestrian, part, numbers: &[f64]| {
                            let place = at(entry, pedestrian, part, head);
                            for (sum, number) in qkv_gradient[place..].iter_mut().zip(numbers) {
                                *sum += number;
                            }
                        };
                        add(i, 0, &gradients.query);
                        for (n, &j) in seen.iter().enumerate() {
                            add(j, 1, &gradients.keys[n]);
                            add(j, 2, &gradients.values[n]);
                        }
                    }
                }
                first += size;
            }
        }
        (mixed, qkv_gradient)
    }

    fn check(&self, tolerance: f64) {
        let (mixed, gradient) = self.expected();
        for set in InstructionSet::available() {
            let (of_mixed, of_gradient) = self.run(set);
            assert_close(&format!("{set:?} mixed"), &of_mixed, &mixed, tolerance);
            assert_close(
                &format!("{set:?} gradient"),
                &of_gradient,
                &gradient,
                tolerance,
            );
        }
    }
}

const STAR: (usize, usize) = (8, 4);

#[test]
fn agrees_with_the_formula() {
    Case::new(1, STAR, &[5, 1, 12, 2, 57, 3], (3, 3), 1.5).check(2e-6);
    Case::new(2, STAR, &[1], (1, 1), 1.5).check(2e-6);
    Case::new(3, STAR, &[25], (4, 1), 1.5).check(2e-6);
}

#[test]
fn agrees_with_the_formula_under_dropout() {
    for p in [0.0, 0.1, 0.7] {
        let mut case = Case::new(4, STAR, &[7, 1, 20, 2], (3, 1), 1.5);
        case.dropout = Some(Dropout { p, seed: 99 });
        case.check(2e-6);
    }
}

/// Any number and width of heads; also full groups of another width, and parts of groups of the usual one.
#[test]
fn agrees_for_other_heads() {
    for heads in [
        (1, 1),
        (3, 4),
        (8, 5),
        (12, 4),
        (16, 4),
        (2, 16),
        (9, 3),
        (8, 8),
    ] {
        let mut case = Case::new(5, heads, &[4, 1, 7], (2, 2), 1.2);
        case.check(2e-6);
        case.dropout = Some(Dropout { p: 0.3, seed: 1 });
        case.check(2e-6);
    }
}

#[test]
fn equal_values_are_mixed_to_themselves() {
    let scenes = Scenes::all_visible(&[1, 2]);
    let mut attended = Attended::default();
    let qkv = vec![0.5; 3 * 96];
    AmongPedestrians::new(8, 4).forward(&qkv, scenes.throughout(), None, &mut attended);
    assert_eq!(attended.mixed(), [0.5; 96]);
}

/// Scores of several hundred: weights of almost 0 and 1, and sums of powers that would overflow without the largest
/// score taken off. Scores are rounded by 3e-5, hence weights as well.
#[test]
fn bears_big_scores() {
    let case = Case::new(6, STAR, &[9, 30], (2, 1), 20.0);
    case.check(2e-4);
    let mut same = Case::new(7, STAR, &[6], (1, 1), 1.0);
    for row in same.qkv.chunks_exact_mut(96) {
        row[..64].fill(1e4); // scores of 2e8, all equal
    }
    same.visible.fill(true);
    let (mixed, _) = same.run(InstructionSet::detect());
    for number in 0..32 {
        let value = |pedestrian: usize| same.qkv[pedestrian * 96 + 64 + number];
        let mean = (0..6).map(value).sum::<f32>() / 6.0;
        for row in mixed.chunks_exact(32) {
            assert!((row[number] - mean).abs() < 1e-6, "{}: {mean}", row[number]);
        }
    }
}

/// What nobody looks at cannot matter, and gets no gradient.
#[test]
fn the_unseen_does_not_matter() {
    let mut case = Case::new(8, STAR, &[4], (1, 1), 1.0);
    let sees = [1, 1, 0, 0, 1, 1, 1, 0, 0, 0, 1, 0, 1, 0, 0, 1];
    case.visible = sees.iter().map(|&sees| sees == 1).collect();
    let set = InstructionSet::detect();
    let (mixed, gradient) = case.run(set);
    // pedestrian 3 sees 0, and only itself sees it: its value only reaches its own row
    case.qkv[3 * 96 + 32..].fill(50.0);
    let (other, _) = case.run(set);
    assert_eq!(mixed[..96], other[..96]);
    assert_ne!(mixed[96..], other[96..]);
    // a pedestrian that sees itself alone mixes its own value, whatever its query
    assert_eq!(mixed[64..96], case.qkv[2 * 96 + 64..3 * 96]);
    assert!(
        gradient[2 * 96..2 * 96 + 32]
            .iter()
            .all(|value| value.abs() < 1e-6)
    );
}

/// The gradient of Σ g · mixed by differences in f64 of the formula, and the formula's own gradient.
#[test]
fn the_gradient_is_that_of_finite_differences() {
    let mut case = Case::new(9, STAR, &[3, 4], (1, 1), 1.5);
    case.dropout = Some(Dropout { p: 0.2, seed: 5 });
    let (_, gradient) = case.run(InstructionSet::detect());
    let step = 2.0_f32.powi(-8);
    for at in (0..case.qkv.len()).step_by(7) {
        let mut total = |change: f32| {
            let value = case.qkv[at];
            case.qkv[at] = value + change;
            let (mixed, _) = case.expected();
            let exact = f64::from(case.qkv[at]);
            case.qkv[at] = value;
            let parts = mixed.iter().zip(&case.gradient);
            (parts.map(|(a, b)| a * f64::from(*b)).sum::<f64>(), exact)
        };
        let ((above, to), (below, from)) = (total(step), total(-step));
        let difference = (above - below) / (to - from);
        let error = (difference - f64::from(gradient[at])).abs();
        assert!(error < 1e-5, "{at}: {difference}, not {}", gradient[at]);
    }
}
