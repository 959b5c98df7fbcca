//! Shape of the part of the proposal network that looks at earlier pedestrians of the place.

use super::range::{not_negative, positive, require};
use crate::NetworkError;
use serde::{Deserialize, Serialize};

/// Shape of the memory branch: attention over earlier pedestrians of the place, and a readout of its own. Its ends are
/// pooled with those that the rest of the network proposes from the observation alone.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MemoryConfig {
    /// Earlier pedestrians looked at, the most alike first.
    pub remembered: usize,
    /// Width of the code of an earlier pedestrian.
    pub width: i64,
    /// Heads of the attention over earlier pedestrians.
    pub heads: i64,
    /// Width of the hidden layers after they have been taken in.
    pub hidden: i64,
    /// Hidden layers after they have been taken in.
    pub layers: usize,
    /// Share of the probability that the ends of the branch have, where somebody is remembered who moved exactly alike.
    pub share: f64,
    /// The share falls off by exp(-d / this), d the squared distance of the most alike.
    pub fade: f64,
}

impl Default for MemoryConfig {
    fn default() -> Self {
        Self {
            remembered: 12,
            width: 64,
            heads: 4,
            hidden: 64,
            layers: 1,
            share: 0.8,
            fade: 32.0,
        }
    }
}

impl MemoryConfig {
    /// Checks every field.
    ///
    /// # Errors
    /// [`NetworkError::Config`] naming the first field that is out of range.
    pub fn check(&self) -> Result<(), NetworkError> {
        // An upper limit keeps a damaged file from asking for all the memory there is.
        for (field, value, most) in [
            ("memory.remembered", self.remembered as i64, 256),
            ("memory.width", self.width, 4096),
            ("memory.heads", self.heads, 64),
            ("memory.hidden", self.hidden, 4096),
            ("memory.layers", self.layers as i64, 16),
        ] {
            let holds = (1..=most).contains(&value);
            require(holds, field, &value, "at least 1 and within reason")?;
        }
        let divides = self.width % self.heads == 0;
        require(
            divides,
            "memory.heads",
            &self.heads,
            "a divisor of memory.width",
        )?;
        let share = self.share;
        require(
            (0.0..=1.0).contains(&share),
            "memory.share",
            &share,
            "0 to 1",
        )?;
        positive("memory.fade", self.fade)
    }

    /// Share of the probability of the ends of the branch, where the most alike that is remembered is at this squared distance.
    pub fn share_at(&self, distance: f64) -> f64 {
        self.share * (-distance / self.fade).exp()
    }
}

/// How the memory branch is trained, after the rest of the network, whose numbers then stay as they are.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MemoryTraining {
    /// Batches.
    pub steps: u64,
    /// Share of the pedestrians of a batch that see a part of what is remembered, each a random part.
    pub partial: f64,
    /// Standard deviation of what is added to the whole track of an earlier pedestrian (metres).
    pub jitter: f64,
}

impl Default for MemoryTraining {
    fn default() -> Self {
        Self {
            steps: 3000,
            partial: 0.5,
            jitter: 0.1,
        }
    }
}

impl MemoryTraining {
    /// Checks every field.
    ///
    /// # Errors
    /// [`NetworkError::Config`] naming the first field that is out of range.
    pub fn check(&self) -> Result<(), NetworkError> {
        require(self.steps > 0, "memory.steps", &self.steps, "at least 1")?;
        let partial = self.partial;
        let holds = (0.0..=1.0).contains(&partial);
        require(holds, "memory.partial", &partial, "0 to 1")?;
        not_negative("memory.jitter", self.jitter)
    }
}
