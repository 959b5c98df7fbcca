//! Sizes of the part of the proposal network that attends to earlier pedestrians of the place.

use crate::NetworkError;
use crate::config::range::{not_negative, positive, require};
use ddl_core::RememberedTrack;
use serde::{Deserialize, Serialize};

/// Sizes of the memory branch: attention over earlier pedestrians of the place, and a separate readout. Its endpoints
/// are pooled with those that the rest of the network proposes from the observation alone.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MemoryConfig {
    /// Number of earlier pedestrians attended to: the most similar ones.
    pub remembered: usize,
    /// Width of the encoding of an earlier pedestrian.
    pub width: i64,
    /// Heads of the attention over earlier pedestrians.
    pub heads: i64,
    /// Width of the hidden layers after the attention.
    pub hidden: i64,
    /// Number of hidden layers after the attention.
    pub layers: usize,
    /// Scale of the weight exp(-d / `fade`) of an earlier pedestrian at the squared distance d.
    pub fade: f64,
    /// Sum of these weights at which the endpoints of the branch get half of the probability.
    pub half: f64,
}

impl Default for MemoryConfig {
    fn default() -> Self {
        Self { remembered: 12, width: 64, heads: 4, hidden: 64, layers: 1, fade: 8.0, half: 0.5 }
    }
}

impl MemoryConfig {
    /// Checks every field.
    ///
    /// # Errors
    /// [`NetworkError::Config`] naming the first field that is out of range.
    pub(crate) fn check(&self) -> Result<(), NetworkError> {
        // The upper limits prevent a damaged file from requesting all memory of the machine.
        for (field, value, most, rule) in [
            ("memory.remembered", self.remembered as i64, 256, "1 to 256"),
            ("memory.width", self.width, 4096, "1 to 4096"),
            ("memory.heads", self.heads, 64, "1 to 64"),
            ("memory.hidden", self.hidden, 4096, "1 to 4096"),
            ("memory.layers", self.layers as i64, 16, "1 to 16"),
        ] {
            require((1..=most).contains(&value), field, &value, rule)?;
        }
        let divides = self.width % self.heads == 0;
        require(divides, "memory.heads", &self.heads, "a divisor of memory.width")?;
        positive("memory.fade", self.fade)?;
        positive("memory.half", self.half)
    }

    /// Share of the probability given to the endpoints of the branch: n / (n + `half`). n is the sum of exp(-d /
    /// `fade`) over the earlier pedestrians attended to, d the squared distance of each. 0 without earlier pedestrians.
    pub fn share(&self, remembered: &[RememberedTrack]) -> f64 {
        let looked_at = remembered.iter().take(self.remembered);
        let alike: f64 = looked_at.map(|other| (-other.distance / self.fade).exp()).sum();
        alike / (alike + self.half)
    }
}

/// Training of the memory branch. It is trained last; the weights of the rest of the network are fixed then.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MemoryTraining {
    /// Number of batches.
    pub steps: u64,
    /// Share of the pedestrians of a batch that receive only a random part of the earlier pedestrians.
    pub partial: f64,
    /// Standard deviation of the offset added to the whole track of an earlier pedestrian (metres).
    pub jitter: f64,
}

impl Default for MemoryTraining {
    fn default() -> Self {
        Self { steps: 3000, partial: 0.5, jitter: 0.1 }
    }
}

impl MemoryTraining {
    /// Checks every field.
    ///
    /// # Errors
    /// [`NetworkError::Config`] naming the first field that is out of range.
    pub(crate) fn check(&self) -> Result<(), NetworkError> {
        require(self.steps > 0, "memory.steps", &self.steps, "at least 1")?;
        let partial = self.partial;
        let holds = (0.0..=1.0).contains(&partial);
        require(holds, "memory.partial", &partial, "0 to 1")?;
        not_negative("memory.jitter", self.jitter)
    }
}
