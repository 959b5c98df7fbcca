//! Temporal attention: the newest token attends to the cached tokens and to itself (Vaswani et al. 2017, section 3.2).

mod backward;
mod forward;
#[cfg(test)]
mod tests;
mod tokens;

use super::heads::Heads;
use super::threads::run_buffered;
use backward::MemoryBackward;
use ddl_simd::Dispatch;
#[cfg(test)]
use ddl_simd::InstructionSet;
use forward::MemoryForward;
use tokens::MemoryBuffers;
pub(crate) use tokens::{KeyValue, KeyValueMut};

/// Rows in a job. They fill whole vectors with any number of heads.
const ROWS_AT_ONCE: usize = 64;

/// Cost of one number of a token, in multiplications.
const WORK_OF_A_NUMBER: usize = 8;

/// Multi-head attention. The query of each row attends to t cached tokens and to its own token.
///
/// For each row and head, `mixed = Σ_e softmax_e(q · k_e / √head width) v_e` over the t + 1 tokens e. Weights below
/// 2^−96 of the largest count as 0. Results do not depend on the number of threads; those of different instruction sets
/// agree up to rounding.
#[derive(Clone, Copy, Debug)]
pub(crate) struct OverMemory {
    heads: Heads,
    dispatch: Dispatch,
}

/// The gradients to which [`OverMemory::backward`] adds.
pub(crate) struct OverMemoryGradients<'a, 'b> {
    /// `[rows, heads, head width]`.
    pub(crate) query: &'a mut [f32],
    pub(crate) memory: &'b mut [KeyValueMut<'a>],
    pub(crate) own: KeyValueMut<'a>,
}

impl OverMemory {
    pub(crate) fn new(heads: usize, head_width: usize) -> Self {
        Self {
            heads: Heads::new(heads, head_width),
            dispatch: Dispatch::detect(),
        }
    }

    #[cfg(test)]
    pub(super) fn with_instructions(self, set: InstructionSet) -> Option<Self> {
        let dispatch = Dispatch::new(set)?;
        Some(Self { dispatch, ..self })
    }

    /// Mixes the values of the cached tokens and the query's own token.
    /// `query` and `own` `[rows, heads, head width]`; each token of `memory` the same, or with a divisor of the rows
    /// -> `mixed` `[rows, heads, head width]`, overwritten.
    ///
    /// The rows of a token with fewer rows are repeated: row r of the query reads its row r mod its number of rows. So
    /// many hypotheses can share one memory.
    pub(crate) fn forward(&self, query: &[f32], memory: &[KeyValue<'_>], own: KeyValue<'_>, mixed: &mut [f32]) {
        self.check(query, own, mixed);
        for token in memory {
            let whole = !token.key.is_empty()
                && token.key.len() == token.value.len()
                && token.key.len().is_multiple_of(self.heads.row())
                && query.len().is_multiple_of(token.key.len());
            assert!(whole || query.is_empty(), "remembered keys and values");
        }
        let chunk = ROWS_AT_ONCE * self.heads.row();
        let chunks = mixed.chunks_mut(chunk).enumerate();
        let jobs: Vec<MemoryForward<'_>> = chunks
            .map(|(i, mixed)| MemoryForward {
                heads: self.heads,
                first: i * chunk,
                query,
                memory,
                own,
                mixed,
            })
            .collect();
        run_buffered::<_, MemoryBuffers>(self.dispatch, jobs, work(query, memory));
    }

    /// Adds the gradients of the inputs of [`OverMemory::forward`], from that of its output.
    /// All shapes are `[rows, heads, head width]`, also those of the cached tokens.
    pub(crate) fn backward(
        &self,
        query: &[f32],
        memory: &[KeyValue<'_>],
        own: KeyValue<'_>,
        mixed_gradient: &[f32],
        gradients: OverMemoryGradients<'_, '_>,
    ) {
        self.check(query, own, mixed_gradient);
        let KeyValueMut { key, value } = &gradients.own;
        self.check(query, KeyValue { key, value }, gradients.query);
        assert_eq!(memory.len(), gradients.memory.len(), "remembered tokens");
        for (token, gradient) in memory.iter().zip(gradients.memory.iter()) {
            self.check(query, *token, gradient.key);
            assert_eq!(gradient.value.len(), query.len(), "gradient of values");
        }
        let chunk = ROWS_AT_ONCE * self.heads.row();
        let OverMemoryGradients {
            query: mut query_gradient,
            memory: token_gradients,
            own: own_gradient,
        } = gradients;
        let mut token_gradients: Vec<KeyValueMut<'_>> = token_gradients.iter_mut().map(KeyValueMut::reborrow).collect();
        token_gradients.push(own_gradient);
        let mut jobs = Vec::new();
        for first in (0..query.len()).step_by(chunk) {
            let count = chunk.min(query.len() - first);
            let tokens = token_gradients.iter_mut();
            jobs.push(MemoryBackward {
                heads: self.heads,
                first,
                query,
                memory,
                own,
                mixed_gradient,
                query_gradient: query_gradient.split_off_mut(..count).unwrap_or_default(),
                token_gradients: tokens.map(|token| token.split_off(count)).collect(),
            });
        }
        run_buffered::<_, MemoryBuffers>(self.dispatch, jobs, work(query, memory));
    }

    fn check(&self, query: &[f32], own: KeyValue<'_>, mixed: &[f32]) {
        assert_eq!(query.len() % self.heads.row(), 0, "rows of queries");
        for (what, other) in [("key", own.key), ("value", own.value), ("mixed", mixed)] {
            assert_eq!(other.len(), query.len(), "{what}");
        }
    }
}

fn work(query: &[f32], memory: &[KeyValue<'_>]) -> usize {
    query.len() * (memory.len() + 1) * WORK_OF_A_NUMBER
}
