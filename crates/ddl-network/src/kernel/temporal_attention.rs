//! Temporal attention: the newest token attends to the cached tokens and to itself (Vaswani et al. 2017, section 3.2).

mod backward;
mod forward;
mod sixteen_heads;
#[cfg(test)]
mod tests;

use crate::kernel::heads::AttentionKernel;
use crate::kernel::threads::run_each;
use backward::TemporalBackward;
use forward::TemporalForward;
pub(crate) use sixteen_heads::KeyValue;

/// Rows in a job. They fill whole vectors with any number of heads.
const ROWS_AT_ONCE: usize = 64;

/// Cost of one number of a token, in multiplications.
const WORK_OF_A_NUMBER: usize = 8;

impl AttentionKernel {
    /// Mixes the values of the t cached tokens and of the query's newest token. For each row and head, `mixed = Σ_e
    /// softmax_e(q · k_e / √head width) v_e` over the t + 1 tokens e.
    ///
    /// `query` and `newest` `[rows, heads, head width]`; each token of `cache` the same, or with a divisor of the rows
    /// -> `mixed` `[rows, heads, head width]`, overwritten.
    ///
    /// The rows of a token with fewer rows are repeated: row r of the query reads its row r mod its number of rows. So
    /// many hypotheses can share one cache.
    pub(crate) fn temporal_forward(
        &self,
        query: &[f32],
        cache: &[KeyValue<&[f32]>],
        newest: KeyValue<&[f32]>,
        mixed: &mut [f32],
    ) {
        self.check_tokens(query, newest, mixed);
        for token in cache {
            let whole = !token.key.is_empty()
                && token.key.len() == token.value.len()
                && token.key.len().is_multiple_of(self.heads.row())
                && query.len().is_multiple_of(token.key.len());
            assert!(whole || query.is_empty(), "cached keys and values");
        }
        let chunk = ROWS_AT_ONCE * self.heads.row();
        let chunks = mixed.chunks_mut(chunk).enumerate();
        let jobs = chunks.map(|(i, mixed)| TemporalForward { first: i * chunk, query, cache, newest, mixed });
        run_each(self.dispatch, jobs, work(query, cache));
    }

    /// Adds the gradients of the inputs of [`AttentionKernel::temporal_forward`], from that of its output.
    /// All shapes are `[rows, heads, head width]`, also those of the cached tokens. `token_gradients` are those of the
    /// cached tokens, then of the newest token.
    pub(crate) fn temporal_backward(
        &self,
        query: &[f32],
        cache: &[KeyValue<&[f32]>],
        newest: KeyValue<&[f32]>,
        mixed_gradient: &[f32],
        mut query_gradient: &mut [f32],
        mut token_gradients: Vec<KeyValue<&mut [f32]>>,
    ) {
        self.check_tokens(query, newest, mixed_gradient);
        assert_eq!(query_gradient.len(), query.len(), "gradient of queries");
        assert_eq!(cache.len() + 1, token_gradients.len(), "cached tokens");
        for (token, gradient) in cache.iter().chain([&newest]).zip(&token_gradients) {
            self.check_tokens(query, *token, gradient.key);
            assert_eq!(gradient.value.len(), query.len(), "gradient of values");
        }
        let chunk = ROWS_AT_ONCE * self.heads.row();
        let mut jobs = Vec::new();
        for first in (0..query.len()).step_by(chunk) {
            let count = chunk.min(query.len() - first);
            let tokens = token_gradients.iter_mut();
            jobs.push(TemporalBackward {
                first,
                query,
                cache,
                newest,
                mixed_gradient,
                query_gradient: query_gradient.split_off_mut(..count).unwrap_or_default(),
                token_gradients: tokens.map(|token| token.split_off(count)).collect(),
            });
        }
        run_each(self.dispatch, jobs.into_iter(), work(query, cache));
    }

    fn check_tokens(&self, query: &[f32], newest: KeyValue<&[f32]>, mixed: &[f32]) {
        assert_eq!(query.len() % self.heads.row(), 0, "rows of queries");
        for (what, other) in [("key", newest.key), ("value", newest.value), ("mixed", mixed)] {
            assert_eq!(other.len(), query.len(), "{what}");
        }
    }
}

fn work(query: &[f32], cache: &[KeyValue<&[f32]>]) -> usize {
    query.len() * (cache.len() + 1) * WORK_OF_A_NUMBER
}
