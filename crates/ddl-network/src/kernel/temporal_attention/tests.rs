//! Comparison with the formula in double precision.

use crate::kernel::heads::AttentionKernel;
use crate::kernel::heads::HEAD_WIDTH;
use crate::kernel::temporal_attention::KeyValue;
use crate::kernel::tests::attention::{Attention, attention};
use crate::kernel::tests::numbers::{SeededNumbers, assert_close, bits};
use ddl_simd::{Dispatch, InstructionSet};
use proptest::prelude::*;

struct TemporalCase {
    heads: usize,
    query: Vec<f32>,
    /// Keys and values of all tokens, the oldest first and the newest token last.
    tokens: [Vec<f32>; 2],
    gradient: Vec<f32>,
}

/// Initial contents of the gradients.
const BEFORE: f32 = 0.25;

impl TemporalCase {
    fn new(seed: u64, heads: usize, rows: usize, cached: usize, bound: f32) -> Self {
        let mut numbers = SeededNumbers::seeded(seed);
        let count = rows * heads * HEAD_WIDTH;
        Self {
            heads,
            tokens: [0; 2].map(|_| numbers.even((cached + 1) * count, bound)),
            query: numbers.even(count, bound),
            gradient: numbers.even(count, 1.0),
        }
    }

    fn cache(&self) -> Vec<KeyValue<&[f32]>> {
        let [keys, values] = self.tokens.each_ref().map(|numbers| numbers.chunks_exact(self.query.len()));
        keys.zip(values).map(|(key, value)| KeyValue { key, value }).collect()
    }

    /// The mixed values, and the gradients of queries, keys and values.
    fn run(&self, set: InstructionSet) -> (Vec<f32>, [Vec<f32>; 3]) {
        let mut attention = AttentionKernel::new(self.heads);
        attention.dispatch = Dispatch::new(set).unwrap();
        let mut cache = self.cache();
        let newest = cache.pop().unwrap();
        let count = self.query.len();
        let mut mixed = vec![f32::NAN; count];
        attention.temporal_forward(&self.query, &cache, newest, &mut mixed);
        let [keys, values] = &self.tokens;
        let mut gradients = [&self.query, keys, values].map(|input| vec![BEFORE; input.len()]);
        let [query, keys, values] = &mut gradients;
        let tokens = keys.chunks_exact_mut(count).zip(values.chunks_exact_mut(count));
        let tokens = tokens.map(|(key, value)| KeyValue { key, value }).collect();
        attention.temporal_backward(&self.query, &cache, newest, &self.gradient, query, tokens);
        (mixed, gradients)
    }

    fn expected(&self) -> Attention {
        let ([keys, values], count) = (&self.tokens, self.query.len());
        let rows = count / (self.heads * HEAD_WIDTH);
        let seen = |row| (row..keys.len() / count * rows).step_by(rows).collect();
        let seen: Vec<Vec<usize>> = (0..rows).map(seen).collect();
        let inputs = [&self.query[..], keys, values];
        let (mixed, gradients) = attention(inputs, &self.gradient, self.heads, &seen, |_, _, _| 1.0);
        let added = |numbers: Vec<f64>| numbers.into_iter().map(|number| f64::from(BEFORE) + number).collect();
        (mixed, gradients.map(added))
    }

    fn check(&self, tolerance: f64) {
        let (mixed, gradients) = self.expected();
        let count = self.query.len();
        for set in InstructionSet::available() {
            let (of_mixed, of_gradients) = self.run(set);
            assert_close(&format!("{set:?} mixed"), &of_mixed, &mixed, tolerance);
            for (i, what) in ["query", "key", "value"].into_iter().enumerate() {
                let tokens = of_gradients[i].chunks(count).zip(gradients[i].chunks(count));
                tokens.for_each(|(a, b)| assert_close(&format!("{set:?} {what}"), a, b, tolerance));
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
        for numbers in &mut case.tokens {
            for token in numbers.chunks_exact_mut(20 * short).take(3) {
                let first = token[..short].to_vec();
                token.copy_from_slice(&first.repeat(20));
            }
        }
        let (whole, _) = case.run(Dispatch::detect().instruction_set());
        let mut cache = case.cache();
        for KeyValue { key, value } in &mut cache[..3] {
            (*key, *value) = (&key[..short], &value[..short]);
        }
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
