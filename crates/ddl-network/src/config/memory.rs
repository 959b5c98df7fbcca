//! Shape of the part of the proposal network that looks at earlier pedestrians of the place.

use super::range::{not_negative, positive, require};
use crate::NetworkError;
use ddl_data::Remembered;
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
    /// An earlier pedestrian at the squared distance d counts exp(-d / this).
    pub fade: f64,
    /// Count of earlier pedestrians at which the ends of the branch have half of the probability.
    pub half: f64,
}

impl Default for MemoryConfig {
    fn default() -> Self {
        Self {
            remembered: 12,
            width: 64,
            heads: 4,
            hidden: 64,
            layers: 1,
            fade: 8.0,
            half: 0.5,
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
        positive("memory.fade", self.fade)?;
        positive("memory.half", self.half)
    }

    /// Share of the probability that the ends of the branch have: n / (n + `half`), where n is the sum of exp(-d / `fade`) over the
    /// earlier pedestrians that are looked at, d the squared distance of each. 0 where there are none.
    pub fn share(&self, remembered: &[Remembered]) -> f64 {
        let looked_at = remembered.iter().take(self.remembered);
        let alike: f64 = looked_at
            .map(|other| (-other.distance / self.fade).exp())
            .sum();
        alike / (alike + self.half)
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
