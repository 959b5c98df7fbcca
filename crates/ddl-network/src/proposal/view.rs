//! What the network sees of a pedestrian.

use ddl_data::{HORIZON, OBSERVED, Position};

/// A pedestrian and those nearby over the observed steps, in the pedestrian's own frame (metres): the
/// last own position is the origin and the heading is +x.
#[derive(Debug, Clone, PartialEq)]
pub struct PedestrianView {
    /// The pedestrian.
    pub own: [Position; OBSERVED],
    /// Others in the scene, nearest first at the last observed step; may be empty, and longer than
    /// what the network looks at.
    pub neighbours: Vec<[Position; OBSERVED]>,
}

/// A pedestrian with its future, in the frame of the view (metres).
#[derive(Debug, Clone, PartialEq)]
pub struct ProposalExample {
    /// What was observed.
    pub view: PedestrianView,
    /// What followed.
    pub future: [Position; HORIZON],
}
