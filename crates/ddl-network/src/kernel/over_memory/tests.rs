//! Against the formula in double precision.
#![allow(clippy::unwrap_used, reason = "a test may panic")]

use super::{KeyValue, KeyValueMut, OverMemory, OverMemoryGradients};
use crate::kernel::tests::attention::Attention;
use crate::kernel::tests::numbers::{Numbers, assert_close, bits, wide};
use ddl_simd::InstructionSet;
use proptest::prelude::*;

/// Tokens are keys and values, oldest first, the own one last.
struct Case {
    heads: (usize, usize),
    query: Vec<f32>,
    tokens: Vec<[Vec<f32>; 2]>,
    gradient: Vec<f32>,
}

#[derive(Debug, PartialEq)]
struct Results<T> {
    mixed: Vec<T>,
    query: Vec<T>,
    tokens: Vec<[Vec<T>; 2]>,
}

/// What is in the gradients before.
const BEFORE: f32 = 0.25;

impl Case {
    fn new(seed: u64, heads: (usize, usize), rows: usize, remembered: usize, bound: f32) -> Self {
        let mut numbers = Numbers(seed);
        let count = rows * heads.0 * heads.1;
        let mut two = || [numbers.even(count, bound), numbers.even(count, bound)];
        Self {
            heads,
            tokens: (0..=remembered).map(|_| two()).collect(),
            query: numbers.even(count, bound),
            gradient: numbers.even(count, 1.0),
        }
    }

    fn run(&self, set: InstructionSet) -> Results<f32> {
        let attention = OverMemory::new(self.heads.0, self.heads.1);
        let attention = attention.with_instructions(set).unwrap();
        let tokens = self
            .tokens
            .iter()
            .map(|[key, value]| KeyValue { key, value });
        let mut memory: Vec<KeyValue<'_>> = tokens.collect();
        let own = memory.pop().unwrap();
        let mut mixed = vec![f32::NAN; self.query.len()];
        attention.forward(&self.query, &memory, own, &mut mixed);
        let before = vec![BEFORE; self.query.len()];
        let mut query = before.clone();
        let mut tokens = vec![[before.clone(), before]; self.tokens.len()];
        let gradients = tokens
            .iter_mut()
            .map(|[key, value]| KeyValueMut { key, value });
        let mut gradients: Vec<KeyValueMut<'_>> = gradients.collect();
        let own_gradient = gradients.pop().unwrap();
        let gradients = OverMemoryGradients {
            query: &mut query,
            memory: &mut gradients,
            own: own_gradient,
        };
        attention.backward(&self.query, &memory, own, &self.gradient, gradients);
        Results {
            mixed,
            query,
            tokens,
        }
    }

    fn expected(&self) -> Results<f64> {
        let width = self.heads.1;
        let (all, gradient) = (wide(&self.query), wide(&self.gradient));
        let tokens: Vec<[Vec<f64>; 2]> = self
            .tokens
            .iter()
            .map(|[key, value]| [wide(key), wide(value)])
            .collect();
        let before = vec![f64::from(BEFORE); all.len()];
        let mut results = Results {
            mixed: Vec::new(),
            query: before.clone(),
            tokens: vec![[before.clone(), before]; tokens.len()],
        };
        for at in (0..all.len()).step_by(width) {
            let here = at..at + width;
            let of = |part: usize| {
                tokens
                    .iter()
                    .map(move |token| part_of(token, part, at, width))
            };
            let (keys, values): (Vec<_>, Vec<_>) = (of(0).collect(), of(1).collect());
            let query = Attention {
                query: &all[here.clone()],
                keys: &keys,
                values: &values,
                factors: &vec![1.0; tokens.len()],
            };
            results.mixed.extend(query.mixed());
            let gradients = query.gradients(&gradient[here.clone()]);
            let add = |into: &mut [f64], numbers: &[f64]| {
                for (sum, number) in into.iter_mut().zip(numbers) {
                    *sum += number;
                }
            };
            add(&mut results.query[here.clone()], &gradients.query);
            for (token, [key, value]) in results.tokens.iter_mut().enumerate() {
                add(&mut key[here.clone()], &gradients.keys[token]);
                add(&mut value[here.clone()], &gradients.values[token]);
            }
        }
        results
    }

    fn check(&self, tolerance: f64) {
        let expected = self.expected();
        for set in InstructionSet::available() {
            let results = self.run(set);
            let close = |what: &str, a: &[f32], b: &[f64]| {
                assert_close(&format!("{set:?} {what}"), a, b, tolerance);
            };
            close("mixed", &results.mixed, &expected.mixed);
            close("query", &results.query, &expected.query);
            for (token, other) in results.tokens.iter().zip(&expected.tokens) {
                close("key", &token[0], &other[0]);
                close("value", &token[1], &other[1]);
            }
        }
    }
}

fn part_of(token: &[Vec<f64>; 2], part: usize, at: usize, width: usize) -> &[f64] {
    &token[part][at..at + width]
}

#[test]
fn agrees_with_the_formula() {
    for (rows, remembered) in [
        (1, 0),
        (1, 1),
        (2, 3),
        (7, 19),
        (64, 5),
        (65, 20),
        (266, 11),
    ] {
        Case::new(1, (8, 4), rows, remembered, 1.5).check(3e-6);
    }
}

#[test]
fn agrees_for_other_heads() {
    for heads in [(1, 1), (3, 4), (8, 5), (16, 4), (2, 16), (9, 3)] {
        Case::new(2, heads, 13, 6, 1.2).check(3e-6);
    }
}

#[test]
fn bears_big_scores() {
    Case::new(3, (8, 4), 9, 8, 20.0).check(2e-4);
}

#[test]
fn equal_scores_give_the_mean() {
    let (key, old, new) = ([0.0; 32], [1.0; 32], [3.0; 32]);
    let token = |value| KeyValue { key: &key, value };
    let mut mixed = [0.0; 32];
    OverMemory::new(8, 4).forward(&[1.0; 32], &[token(&old)], token(&new), &mut mixed);
    assert_eq!(bits(&mixed), bits(&[2.0; 32]));
}

/// One memory for several hypotheses is the memory repeated.
#[test]
fn a_memory_of_fewer_rows_is_repeated() {
    for rows in [1, 5, 25, 64] {
        let mut case = Case::new(4, (8, 4), rows * 20, 6, 1.5);
        let short = rows * 32;
        for [key, value] in &mut case.tokens[..3] {
            for all in [key, value] {
                let first = all[..short].to_vec();
                *all = first.repeat(20);
            }
        }
        let whole = case.run(InstructionSet::detect()).mixed;
        let tokens = case.tokens.iter().enumerate().map(|(token, [key, value])| {
            let length = if token < 3 { short } else { key.len() };
            KeyValue {
                key: &key[..length],
                value: &value[..length],
            }
        });
        let mut memory: Vec<KeyValue<'_>> = tokens.collect();
        let own = memory.pop().unwrap();
        let mut mixed = vec![0.0; whole.len()];
        OverMemory::new(8, 4).forward(&case.query, &memory, own, &mut mixed);
        assert!(bits(&mixed) == bits(&whole), "{rows} rows");
    }
}

/// Big enough for more than one thread to work.
#[test]
fn threads_change_no_bit() {
    let case = Case::new(5, (8, 4), 700, 12, 1.5);
    let run = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        pool.unwrap().install(|| case.run(InstructionSet::detect()))
    };
    let one = run(1);
    for threads in [2, 5] {
        assert!(run(threads) == one, "{threads} threads");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn values_and_gradients_are_those_of_the_formula(
        seed: u64, rows in 1_usize..40, remembered in 0_usize..21, bound in 0.1_f32..3.0,
    ) {
        Case::new(seed, (8, 4), rows, remembered, bound).check(5e-6);
    }

    /// The tokens' order is of no account.
    #[test]
    fn tokens_may_come_in_any_order(seed: u64, rows in 1_usize..9, remembered in 1_usize..12) {
        let mut case = Case::new(seed, (8, 4), rows, remembered, 1.5);
        let set = InstructionSet::detect();
        let mixed = case.run(set).mixed;
        case.tokens.reverse();
        assert_close("mixed", &case.run(set).mixed, &wide(&mixed), 2e-6);
    }
}

#[test]
#[should_panic(expected = "key of 64 numbers for queries of 32")]
fn refuses_keys_that_do_not_fit() {
    let (key, value) = ([0.0; 64], [0.0; 32]);
    let own = KeyValue {
        key: &key,
        value: &value,
    };
    OverMemory::new(8, 4).forward(&[0.0; 32], &[], own, &mut [0.0; 32]);
}
