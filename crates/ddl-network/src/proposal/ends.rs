//! What the network sees of a pedestrian, the ends it proposes, and who proposes them.

use crate::weights::Weights;
use crate::{NetworkError, ProposalConfig};
use ddl_data::{HORIZON, OBSERVED, Position, Remembered};
use std::fmt::Debug;

/// Ends lie within a few metres of where the present velocity leads: the unit of the last layer (m).
pub const END_UNIT: f64 = 3.0;

/// A pedestrian and those nearby over the observed steps, in the pedestrian's own frame (metres): the
/// last own position is the origin and the heading is +x.
#[derive(Debug, Clone, PartialEq)]
pub struct PedestrianView {
    /// The pedestrian.
    pub own: [Position; OBSERVED],
    /// Others in the scene, nearest first at the last observed step; any number of them.
    pub neighbours: Vec<[Position; OBSERVED]>,
    /// What earlier pedestrians of the place did who had moved like this one, the most alike first; any number of them.
    pub remembered: Vec<Remembered>,
}

/// A pedestrian with its future, in the frame of the view (metres).
#[derive(Debug, Clone, PartialEq)]
pub struct ProposalExample {
    /// What was observed.
    pub view: PedestrianView,
    /// What followed.
    pub future: [Position; HORIZON],
}

/// Ends proposed for one pedestrian, those of all members one after the other, then those of all memory branches.
#[derive(Debug, Clone, PartialEq)]
pub struct ProposedEnds {
    /// Ends in the pedestrian's frame (metres): members x K of them, twice as many where something is remembered and the
    /// network has a memory branch.
    pub ends: Vec<Position>,
    /// Probability of each to be the nearest to the true end; sums to 1.
    pub weights: Vec<f64>,
}

/// A network that proposes ends, whoever computes it.
pub trait ProposeEnds: Debug + Send + Sync {
    /// Its shape.
    fn config(&self) -> &ProposalConfig;

    /// A copy of the learned numbers.
    ///
    /// # Errors
    /// When they cannot be fetched from their device.
    fn copy_weights(&self) -> Result<Weights, NetworkError>;

    /// Proposes ends for each of the pedestrians.
    ///
    /// # Shapes
    /// One [`ProposedEnds`] a view, in their order: places in metres ahead and to the left.
    ///
    /// # Errors
    /// When the implementation fails, for want of memory for instance.
    fn propose(&self, views: &[PedestrianView]) -> Result<Vec<ProposedEnds>, NetworkError>;
}
