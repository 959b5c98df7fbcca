//! What a backbone keeps of earlier time steps.

use super::operations::Backend;

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
