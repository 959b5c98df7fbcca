//! The operations that a backbone is made of, and what it keeps between them.

use crate::weights::{EncoderLayer, Linear};
use std::fmt::Debug;

/// Whether dropout is active.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Mode {
    /// Dropout on.
    Train,
    /// Dropout off: the forecast is a function of its inputs.
    Evaluate,
}

/// The operations that a backbone is made of.
///
/// Tokens are `[B, P, width]`: batch entries (hypotheses, or time steps), pedestrians of all scenes one after the other, numbers.
pub trait Backend: Debug + Sized + 'static {
    /// Tokens on their way; cloning is cheap.
    type Tokens: Debug + Clone;
    /// Keys and values of tokens, for later queries; cloning is cheap.
    type KeyValues: Debug + Clone;
    /// Who sees whom during one time step, or one for each batch entry.
    type Seen: Debug + Clone;

    /// B.
    fn entries(&self, x: &Self::Tokens) -> usize;

    /// `[B, P, inputs]` -> `[B, P, outputs]`.
    fn linear(&self, layer: Linear, x: &Self::Tokens) -> Self::Tokens;

    /// max(0, x), number by number.
    fn relu(&self, x: &Self::Tokens) -> Self::Tokens;

    /// Both side by side, `[B, P, width + width of other]`.
    fn beside(&self, x: &Self::Tokens, other: &Self::Tokens) -> Self::Tokens;

    /// A single batch entry `batch` times; the same tokens where there are as many already.
    fn repeated(&self, x: &Self::Tokens, batch: usize) -> Self::Tokens;

    /// An encoder layer in which every pedestrian attends to those of its scene that it sees.
    fn spatial_attention(
        &self,
        layer: EncoderLayer,
        x: &Self::Tokens,
        seen: &Self::Seen,
    ) -> Self::Tokens;

    /// An encoder layer in which every newest token attends to the cached ones of its pedestrian and to itself.
    fn temporal_attention(
        &self,
        layer: EncoderLayer,
        newest: &Self::Tokens,
        cache: &[Self::KeyValues],
    ) -> Self::Tokens;

    /// Keys and values of tokens in an encoder layer, to be cached.
    fn key_values(&self, layer: EncoderLayer, x: &Self::Tokens) -> Self::KeyValues;

    /// Those of a single batch entry for `batch` entries.
    fn repeated_key_values(&self, cached: &Self::KeyValues, batch: usize) -> Self::KeyValues;
}

/// What a backbone keeps of earlier time steps.
#[derive(Debug)]
pub struct Memory<B: Backend> {
    /// Key-value caches, one for each temporal attention, oldest token first.
    pub caches: Vec<Vec<B::KeyValues>>,
    /// Other tokens, as the backbone needs them.
    pub tokens: Vec<B::Tokens>,
}

impl<B: Backend> Default for Memory<B> {
    fn default() -> Self {
        Self {
            caches: Vec::new(),
            tokens: Vec::new(),
        }
    }
}

impl<B: Backend> Memory<B> {
    /// Repeats a single batch entry `batch` times.
    #[must_use]
    pub fn repeated(&self, backend: &B, batch: usize) -> Self {
        let of_cache = |cache: &Vec<B::KeyValues>| {
            let cached = cache.iter();
            cached
                .map(|one| backend.repeated_key_values(one, batch))
                .collect()
        };
        Self {
            caches: self.caches.iter().map(of_cache).collect(),
            tokens: self
                .tokens
                .iter()
                .map(|x| backend.repeated(x, batch))
                .collect(),
        }
    }
}
