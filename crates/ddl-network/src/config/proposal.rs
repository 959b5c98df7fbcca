//! Shape of the proposal network, and how it is trained.

use super::memory::{MemoryConfig, MemoryTraining};
use super::range::{at_least_one, not_negative, positive, require};
use crate::NetworkError;
use serde::{Deserialize, Serialize};

/// Shape of the proposal network.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ProposalConfig {
    /// Networks of the ensemble, each trained on its own batches.
    pub members: i64,
    /// Ends K that each member proposes.
    pub ends: i64,
    /// Width of the hidden layers.
    pub width: i64,
    /// Hidden layers after the neighbours have been taken in.
    pub layers: usize,
    /// Width of a neighbour's code.
    pub neighbour_width: i64,
    /// Heads of the attention over neighbours.
    pub heads: i64,
    /// Nearest neighbours looked at.
    pub neighbours: usize,
    /// Neighbours further away than this at the last observed step are not looked at (metres).
    pub neighbour_range: f64,
    /// Seconds between two positions.
    pub time_step: f64,
    /// The part that looks at earlier pedestrians of the place; `None` without it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub memory: Option<MemoryConfig>,
}

impl Default for ProposalConfig {
    fn default() -> Self {
        Self {
            members: 4,
            ends: 20,
            width: 192,
            layers: 2,
            neighbour_width: 64,
            heads: 4,
            neighbours: 8,
            neighbour_range: 6.0,
            time_step: 0.4,
            memory: Some(MemoryConfig::default()),
        }
    }
}

impl ProposalConfig {
    /// Weights of its largest layers alone: the network has more numbers than these, and a file with fewer is not of it.
    ///
    /// # Panics
    /// Where numbers overflow, which [`check`](Self::check) excludes.
    pub fn least_numbers(&self) -> u64 {
        let [members, ends, width, near] =
            [self.members, self.ends, self.width, self.neighbour_width].map(|size| size as u64);
        // hidden layers, attention, and for each end a place and a probability: packed models have no waypoints
        let part = |layers: usize, hidden: u64, near: u64| {
            let layers = width * hidden + (layers as u64 - 1) * hidden * hidden;
            layers + near * (3 * near + width) + 3 * hidden * ends
        };
        let of_memory =
            |memory: &MemoryConfig| part(memory.layers, memory.hidden as u64, memory.width as u64);
        members * (part(self.layers, width, near) + self.memory.as_ref().map_or(0, of_memory))
    }

    /// Checks every field.
    ///
    /// # Errors
    /// [`NetworkError::Config`] naming the first field that is out of range.
    pub fn check(&self) -> Result<(), NetworkError> {
        // An upper limit keeps a damaged file from asking for all the memory there is.
        for (field, value, most) in [
            ("members", self.members, 64),
            ("ends", self.ends, 1024),
            ("width", self.width, 4096),
            ("neighbour_width", self.neighbour_width, 4096),
            ("heads", self.heads, 64),
            ("neighbours", self.neighbours as i64, 256),
        ] {
            let holds = (1..=most).contains(&value);
            require(holds, field, &value, "at least 1 and within reason")?;
        }
        let layers = self.layers;
        require((1..=16).contains(&layers), "layers", &layers, "1 to 16")?;
        let divides = self.neighbour_width % self.heads == 0;
        require(
            divides,
            "heads",
            &self.heads,
            "a divisor of neighbour_width",
        )?;
        not_negative("neighbour_range", self.neighbour_range)?;
        positive("time_step", self.time_step)?;
        self.memory.as_ref().map_or(Ok(()), MemoryConfig::check)
    }
}

/// How the proposal network is trained.
///
/// The defaults were chosen on validation splits of training recordings (`docs/tried.md`).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ProposalTraining {
    /// Batches.
    pub steps: u64,
    /// Pedestrians a batch, for each member.
    pub batch: i64,
    /// Largest step size of Adam; it rises, then falls along a half cosine.
    pub learning_rate: f64,
    /// Largest allowed norm of a member's gradient, on average.
    pub gradient_clip: f64,
    /// Nearest ends that share the loss at the start; falls to 1, the winner alone.
    pub relaxed_ends: f64,
    /// Share of the training after which the winner takes all.
    pub relaxed_share: f64,
    /// Weight of the waypoints' distances in the loss, beside that of the end.
    pub waypoint_weight: f64,
    /// Weight of the cross-entropy of the ends' probabilities (metres).
    pub probability_weight: f64,
    /// Scenes are enlarged by exp(u), u uniform within ± this.
    pub scale: f64,
    /// Scenes are turned by a normal angle of this standard deviation (radians).
    pub turn: f64,
    /// Largest standard deviation of what is added to every observed position (metres); each pedestrian's is uniform from 0 to this.
    pub jitter: f64,
    /// Standard deviation of what is added to a neighbour's whole track (metres).
    pub neighbour_jitter: f64,
    /// Share of the pedestrians that see no neighbours in a batch.
    pub blindness: f64,
    /// Share of the pedestrians that walk backwards in time in a batch, where there are any to draw from.
    pub reversed: f64,
    /// Seed of initial weights, batches and augmentation.
    pub seed: u64,
    /// How the memory branch is trained, in a network that has one.
    #[serde(default)]
    pub memory: MemoryTraining,
}

impl Default for ProposalTraining {
    fn default() -> Self {
        Self {
            steps: 1500,
            batch: 256,
            learning_rate: 1e-3,
            gradient_clip: 5.0,
            relaxed_ends: 10.0,
            relaxed_share: 0.6,
            waypoint_weight: 0.5,
            probability_weight: 0.1,
            scale: 0.35,
            turn: 0.1,
            jitter: 0.08,
            neighbour_jitter: 0.3,
            blindness: 0.3,
            reversed: 0.3,
            seed: 1,
            memory: MemoryTraining::default(),
        }
    }
}

impl ProposalTraining {
    /// Checks every field.
    ///
    /// # Errors
    /// [`NetworkError::Config`] naming the first field that is out of range.
    pub fn check(&self) -> Result<(), NetworkError> {
        at_least_one("steps", self.steps)?;
        require(self.batch > 0, "batch", &self.batch, "at least 1")?;
        positive("learning_rate", self.learning_rate)?;
        positive("gradient_clip", self.gradient_clip)?;
        let relaxed = self.relaxed_ends;
        let holds = relaxed.is_finite() && relaxed >= 1.0;
        require(holds, "relaxed_ends", &relaxed, "finite and at least 1")?;
        for (field, value) in [
            ("relaxed_share", self.relaxed_share),
            ("blindness", self.blindness),
            ("reversed", self.reversed),
        ] {
            require((0.0..=1.0).contains(&value), field, &value, "0 to 1")?;
        }
        not_negative("waypoint_weight", self.waypoint_weight)?;
        not_negative("probability_weight", self.probability_weight)?;
        not_negative("scale", self.scale)?;
        not_negative("turn", self.turn)?;
        not_negative("jitter", self.jitter)?;
        not_negative("neighbour_jitter", self.neighbour_jitter)?;
        self.memory.check()
    }

    /// How many of the nearest ends share the loss of a step of so many, a fraction counting for the last.
    pub fn relaxed_at(&self, step: u64, steps: u64) -> f64 {
        let done = step as f64 / steps as f64;
        let left = if self.relaxed_share > 0.0 {
            (1.0 - done / self.relaxed_share).max(0.0)
        } else {
            0.0
        };
        1.0 + (self.relaxed_ends - 1.0) * left
    }
}

#[cfg(test)]
mod tests {
    use super::ProposalTraining;

    #[test]
    fn the_winner_takes_all_in_the_end() {
        let training = ProposalTraining::default();
        assert!((training.relaxed_at(0, 1500) - 10.0).abs() < 1e-12);
        assert!((training.relaxed_at(450, 1500) - 5.5).abs() < 1e-12);
        assert!((training.relaxed_at(1499, 1500) - 1.0).abs() < 1e-12);
    }
}
