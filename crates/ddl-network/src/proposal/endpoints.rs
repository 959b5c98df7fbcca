//! Input and output of a proposal network, and its interface.

use crate::weights::Weights;
use crate::{NetworkError, ProposalConfig};
use ddl_core::{HORIZON, OBSERVED, Position, RememberedTrack};
use std::fmt::Debug;

/// Unit of length of the last layer (m). Endpoints are within a few metres of the extrapolation of the present
/// velocity.
pub const ENDPOINT_UNIT: f64 = 3.0;

/// The input for one pedestrian: observed positions in the pedestrian's own frame (metres). The origin is its last
/// position, and its heading is +x.
#[derive(Debug, Clone, PartialEq)]
pub struct PedestrianView {
    /// The pedestrian.
    pub own: [Position; OBSERVED],
    /// Any number of other pedestrians of the scene, the nearest at the last observed time step first.
    pub neighbours: Vec<[Position; OBSERVED]>,
    /// Any number of earlier pedestrians of the place that moved similarly, the most similar first.
    pub remembered: Vec<RememberedTrack>,
}

/// A training example: a pedestrian with its future, in the frame of the view (metres).
#[derive(Debug, Clone, PartialEq)]
pub struct ProposalExample {
    /// The observation.
    pub view: PedestrianView,
    /// The positions after it.
    pub future: [Position; HORIZON],
}

/// The endpoints proposed for one pedestrian: first those of all members, then those of all memory branches.
#[derive(Debug, Clone, PartialEq)]
pub struct ProposedEndpoints {
    /// Endpoints in the pedestrian's frame (metres): members x K of them. Twice as many if the network has a memory
    /// branch and the view has earlier pedestrians.
    pub endpoints: Vec<Position>,
    /// Probability of each endpoint to be the nearest to the true one; the sum is 1.
    pub weights: Vec<f64>,
}

/// A network that proposes endpoints: kernels on the CPU, or libtorch in `ddl-star`.
pub trait ProposeEndpoints: Debug + Send + Sync {
    /// Its sizes.
    fn config(&self) -> &ProposalConfig;

    /// A copy of the weights.
    ///
    /// # Errors
    /// If the weights cannot be copied from their device.
    fn copy_weights(&self) -> Result<Weights, NetworkError>;

    /// Proposes endpoints for each pedestrian.
    ///
    /// # Shapes
    /// One [`ProposedEndpoints`] for each view, in the same order: metres ahead and metres to the left.
    ///
    /// # Errors
    /// If the implementation fails, for example if a device has too little memory.
    fn propose(&self, views: &[PedestrianView]) -> Result<Vec<ProposedEndpoints>, NetworkError>;
}
