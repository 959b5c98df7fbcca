//! Sizes of the proposal network, and settings of its training.

use crate::NetworkError;
use crate::config::memory::{MemoryConfig, MemoryTraining};
use crate::config::range::{at_least_one, not_negative, positive, require};
use serde::{Deserialize, Serialize};

/// Sizes of the proposal network.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ProposalConfig {
    /// Number of networks in the ensemble, each trained on its own batches.
    pub members: i64,
    /// Number K of endpoints that each member proposes.
    pub ends: i64,
    /// Width of the hidden layers.
    pub width: i64,
    /// Number of hidden layers after the attention over neighbours.
    pub layers: usize,
    /// Width of the encoding of a neighbour.
    pub neighbour_width: i64,
    /// Heads of the attention over neighbours.
    pub heads: i64,
    /// Number of nearest neighbours attended to.
    pub neighbours: usize,
    /// Largest distance of a neighbour attended to, at the last observed time step (metres).
    pub neighbour_range: f64,
    /// Seconds between two positions.
    pub time_step: f64,
    /// The branch that attends to earlier pedestrians of the place; `None` for a network without it.
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
    /// Number of weights in the largest layers: a lower bound for the whole network. A file with fewer weights cannot
    /// belong to this configuration.
    ///
    /// # Panics
    /// On overflow, which [`check`](Self::check) excludes.
    pub fn min_weight_count(&self) -> u64 {
        let [members, ends, width, near] =
            [self.members, self.ends, self.width, self.neighbour_width].map(|size| size as u64);
        // Hidden layers, attention, and a position and a probability for each endpoint. Packed models have no
        // waypoints.
        let part = |layers: usize, hidden: u64, near: u64| {
            let layers = width * hidden + (layers as u64 - 1) * hidden * hidden;
            layers + near * (3 * near + width) + 3 * hidden * ends
        };
        let of_memory = |memory: &MemoryConfig| part(memory.layers, memory.hidden as u64, memory.width as u64);
        members * (part(self.layers, width, near) + self.memory.as_ref().map_or(0, of_memory))
    }

    /// Checks every field.
    ///
    /// # Errors
    /// [`NetworkError::Config`] naming the first field that is out of range.
    pub fn check(&self) -> Result<(), NetworkError> {
        // The upper limits prevent a damaged file from requesting all memory of the machine.
        for (field, value, most, rule) in [
            ("members", self.members, 64, "1 to 64"),
            ("ends", self.ends, 1024, "1 to 1024"),
            ("width", self.width, 4096, "1 to 4096"),
            ("layers", self.layers as i64, 16, "1 to 16"),
            ("neighbour_width", self.neighbour_width, 4096, "1 to 4096"),
            ("heads", self.heads, 64, "1 to 64"),
            ("neighbours", self.neighbours as i64, 256, "1 to 256"),
        ] {
            require((1..=most).contains(&value), field, &value, rule)?;
        }
        let divides = self.neighbour_width % self.heads == 0;
        require(divides, "heads", &self.heads, "a divisor of neighbour_width")?;
        not_negative("neighbour_range", self.neighbour_range)?;
        positive("time_step", self.time_step)?;
        self.memory.as_ref().map_or(Ok(()), MemoryConfig::check)
    }
}

/// Training of the proposal network.
///
/// The defaults were chosen on validation splits of training recordings (`docs/tried.md`).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ProposalTraining {
    /// Number of batches.
    pub steps: u64,
    /// Pedestrians in a batch, for each member.
    pub batch: i64,
    /// Largest step size of Adam; the step size rises to it, then falls along a half cosine.
    pub learning_rate: f64,
    /// Largest norm of a member's gradient, as the root mean square over the members.
    pub gradient_clip: f64,
    /// Number of nearest endpoints that share the loss at the start; it falls to 1 during training.
    pub relaxed_ends: f64,
    /// Share of the training after which only the nearest endpoint contributes to the loss.
    pub relaxed_share: f64,
    /// Weight of the waypoints' distances in the loss, relative to the endpoint's distance.
    pub waypoint_weight: f64,
    /// Weight of the cross-entropy of the endpoints' probabilities in the loss (metres).
    pub probability_weight: f64,
    /// Scenes are scaled by exp(u), with u uniform in ±`scale`.
    pub scale: f64,
    /// Standard deviation of the normally distributed angle by which scenes are rotated (radians).
    pub turn: f64,
    /// Largest standard deviation of the errors added to observed positions (metres). The deviation of each pedestrian
    /// is uniform from 0 to this.
    pub jitter: f64,
    /// Standard deviation of the offset added to a neighbour's whole track (metres).
    pub neighbour_jitter: f64,
    /// Share of the pedestrians of a batch whose neighbours are hidden.
    pub blindness: f64,
    /// Share of the pedestrians of a batch whose track is reversed in time, if there are reversed tracks.
    pub reversed: f64,
    /// Seed of initial weights, batches and augmentation.
    pub seed: u64,
    /// Training of the memory branch, in a network that has one.
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
        for (field, value) in
            [("relaxed_share", self.relaxed_share), ("blindness", self.blindness), ("reversed", self.reversed)]
        {
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

    /// Number of nearest endpoints that share the loss at step `step` of `steps`. For a fractional number, the fraction
    /// is the weight of the last endpoint.
    pub fn relaxed_ends_at(&self, step: u64, steps: u64) -> f64 {
        let done = step as f64 / steps as f64;
        let left = if self.relaxed_share > 0.0 { (1.0 - done / self.relaxed_share).max(0.0) } else { 0.0 };
        1.0 + (self.relaxed_ends - 1.0) * left
    }
}

#[cfg(test)]
mod tests {
    use super::ProposalTraining;

    #[test]
    fn the_number_of_relaxed_endpoints_falls_to_one() {
        let training = ProposalTraining::default();
        assert!((training.relaxed_ends_at(0, 1500) - 10.0).abs() < 1e-12);
        assert!((training.relaxed_ends_at(450, 1500) - 5.5).abs() < 1e-12);
        assert!((training.relaxed_ends_at(1499, 1500) - 1.0).abs() < 1e-12);
    }
}
