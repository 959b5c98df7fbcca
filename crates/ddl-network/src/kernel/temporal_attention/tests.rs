//! Comparison with the formula in double precision.

use crate::kernel::heads::AttentionKernel;
use crate::kernel::heads::HEAD_WIDTH;
use crate::kernel::temporal_attention::{KeyValue, KeyValueMut};
use crate::kernel::tests::attention::Attention;
use crate::kernel::tests::numbers::{Numbers, assert_close, bits, wide};
use ddl_simd::{Dispatch, InstructionSet};
use proptest::prelude::*;

/// Tokens are keys and values, the oldest first and the newest token last.
struct TemporalCase {
    heads: usize,
    query: Vec<f32>,
    tokens: Vec<[Vec<f32>; 2]>,
    gradient: Vec<f32>,
}

struct TemporalResults<T> {
    mixed: Vec<T>,
    query: Vec<T>,
    tokens: Vec<[Vec<T>; 2]>,
}

/// Initial contents of the gradients.
const BEFORE: f32 = 0.25;

impl TemporalCase {
    fn new(seed: u64, heads: usize, rows: usize, cached: usize, bound: f32) -> Self {
        let mut numbers = Numbers::seeded(seed);
        let count = rows * heads * HEAD_WIDTH;
        let mut two = || [numbers.even(count, bound), numbers.even(count, bound)];
        Self {
            heads,
            tokens: (0..=cached).map(|_| two()).collect(),
            query: numbers.even(count, bound),
            gradient: numbers.even(count, 1.0),
        }
    }

    fn run(&self, set: InstructionSet) -> TemporalResults<f32> {
        let attention = AttentionKernel::new(self.heads);
        let attention = attention.with_instructions(set).unwrap();
        let tokens = self.tokens.iter().map(|[key, value]| KeyValue { key, value });
        let mut cache: Vec<KeyValue<'_>> = tokens.collect();
        let newest = cache.pop().unwrap();
        let mut mixed = vec![f32::NAN; self.query.len()];
        attention.temporal_forward(&self.query, &cache, newest, &mut mixed);
        let before = vec![BEFORE; self.query.len()];
        let mut query = before.clone();
        let mut tokens = vec![[before.clone(), before]; self.tokens.len()];
        let gradients = tokens.iter_mut().map(|[key, value]| KeyValueMut { key, value });
        let gradients = gradients.collect();
        attention.temporal_backward(&self.query, &cache, newest, &self.gradient, &mut query, gradients);
        TemporalResults { mixed, query, tokens }
    }

    fn expected(&self) -> TemporalResults<f64> {
        let width = HEAD_WIDTH;
        let (query, gradient) = (wide(&self.query), wide(&self.gradient));
        let tokens: Vec<[Vec<f64>; 2]> = self
            .tokens
            .iter()
            .map(|[key, value]| [wide(key), wide(value)])
            .collect();
        let before = vec![f64::from(BEFORE); query.len()];
        let mut results = TemporalResults {
            mixed: Vec::new(),
            query: before.clone(),
            tokens: vec![[before.clone(), before]; tokens.len()],
        };
        for first in (0..query.len()).step_by(width) {
            let here = first..first + width;
            let [keys, values] = [0, 1].map(|part| -> Vec<&[f64]> {
                let tokens = tokens.iter();
                tokens.map(|token| &token[part][here.clone()]).collect()
            });
            let attention = Attention {
                query: &query[here.clone()],
                keys: &keys,
                values: &values,
                factors: &vec![1.0; tokens.len()],
            };
            results.mixed.extend(attention.mixed());
            let gradients = attention.gradients(&gradient[here.clone()]);
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

#[test]
fn bears_big_scores() {
    TemporalCase::new(3, 8, 9, 8, 20.0).check(2e-4);
}

#[test]
fn a_memory_of_fewer_rows_is_repeated() {
    for rows in [1, 5, 25, 64] {
        let mut case = TemporalCase::new(4, 8, rows * 20, 6, 1.5);
        let short = rows * 32;
        for [key, value] in &mut case.tokens[..3] {
            for numbers in [key, value] {
                let first = numbers[..short].to_vec();
                *numbers = first.repeat(20);
            }
        }
        let whole = case.run(Dispatch::detect().instruction_set()).mixed;
        let tokens = case.tokens.iter().enumerate().map(|(token, [key, value])| {
            let length = if token < 3 { short } else { key.len() };
            KeyValue {
                key: &key[..length],
                value: &value[..length],
            }
        });
        let mut cache: Vec<KeyValue<'_>> = tokens.collect();
        let newest = cache.pop().unwrap();
        let mut mixed = vec![0.0; whole.len()];
        AttentionKernel::new(8).temporal_forward(&case.query, &cache, newest, &mut mixed);
        assert!(bits(&mixed) == bits(&whole), "{rows} rows");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(96))]

    #[test]
    fn values_and_gradients_are_those_of_the_formula(
        heads in prop::sample::select(vec![8, 8, 1, 3, 16]),
        seed: u64,
        rows in prop_oneof![1_usize..40, 60_usize..70, Just(266)],
        cached in 0_usize..21,
        bound in 0.1_f32..3.0,
    ) {
        TemporalCase::new(seed, heads, rows, cached, bound).check(5e-6);
    }
}
