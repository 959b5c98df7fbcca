//! The operations that a backbone consists of, and its memory of earlier time steps.

use crate::weights::{EncoderLayer, Linear};
use std::fmt::Debug;

/// Whether dropout is active.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Mode {
    /// With dropout.
    Train,
    /// Without dropout: the forecast is deterministic.
    Evaluate,
}

/// The operations that a backbone consists of.
///
/// Tokens are `[B, P, width]`: B batch entries (hypotheses or time steps), and P pedestrians of all scenes in sequence.
pub trait Backend: Debug + Sized + 'static {
    /// Tokens; cloning is cheap.
    type Tokens: Debug + Clone;
    /// Keys and values of tokens, for later queries; cloning is cheap.
    type KeyValues: Debug + Clone;
    /// Visibility masks of one time step, or of one time step for each batch entry.
    type Seen: Debug + Clone;

    /// The number of batch entries B.
    fn entries(&self, x: &Self::Tokens) -> usize;

    /// `[B, P, inputs]` -> `[B, P, outputs]`.
    fn linear(&self, layer: Linear, x: &Self::Tokens) -> Self::Tokens;

    /// max(0, x), elementwise.
    fn relu(&self, x: &Self::Tokens) -> Self::Tokens;

    /// Concatenates both along the width: `[B, P, width + width of other]`.
    fn concatenate(&self, x: &Self::Tokens, other: &Self::Tokens) -> Self::Tokens;

    /// Repeats a single batch entry `batch` times; returns `x` itself if it has `batch` entries already.
    fn repeated(&self, x: &Self::Tokens, batch: usize) -> Self::Tokens;

    /// An encoder layer in which each pedestrian attends to the visible pedestrians of its scene.
    fn spatial_attention(&self, layer: EncoderLayer, x: &Self::Tokens, seen: &Self::Seen) -> Self::Tokens;

    /// An encoder layer in which each newest token attends to the cached tokens of its pedestrian and to itself.
    fn temporal_attention(&self, layer: EncoderLayer, newest: &Self::Tokens, cache: &[Self::KeyValues])
    -> Self::Tokens;

    /// Adds the keys and values of tokens in an encoder layer to a cache.
    fn remember(&self, layer: EncoderLayer, x: &Self::Tokens, cache: &mut Vec<Self::KeyValues>);

    /// Repeats the keys and values of a single batch entry `batch` times.
    fn repeat_key_values(&self, cached: &Self::KeyValues, batch: usize) -> Self::KeyValues;
}

/// The memory that a backbone has of earlier time steps.
#[derive(Debug)]
pub struct Memory<B: Backend> {
    /// Key-value caches, one for each temporal attention, oldest token first.
    pub caches: Vec<Vec<B::KeyValues>>,
    /// Other tokens that the backbone needs.
    pub tokens: Vec<B::Tokens>,
}

impl<B: Backend> Default for Memory<B> {
    fn default() -> Self {
        Self { caches: Vec::new(), tokens: Vec::new() }
    }
}

impl<B: Backend> Memory<B> {
    /// Repeats a single batch entry `batch` times.
    #[must_use]
    pub fn repeated(&self, backend: &B, batch: usize) -> Self {
        let of_cache =
            |cache: &Vec<B::KeyValues>| cache.iter().map(|one| backend.repeat_key_values(one, batch)).collect();
        Self {
            caches: self.caches.iter().map(of_cache).collect(),
            tokens: self.tokens.iter().map(|x| backend.repeated(x, batch)).collect(),
        }
    }
}
