//! A small network that proposes endpoints: where a pedestrian may be at the end of the horizon. Its input is one
//! pedestrian, in its own frame, and the pedestrians nearby. It is an ensemble of members that propose K endpoints
//! each. The loss is the distance of the nearest of the K endpoints from the true one ("winner takes all").

mod endpoints;
mod layers;
mod member;
mod network;
mod remembered;
mod seen;

pub use endpoints::{ENDPOINT_UNIT, PedestrianView, ProposalExample, ProposeEndpoints, ProposedEndpoints};
pub use layers::{AttentionLayers, MemberAffine, ProposalLayers, ReadoutLayers, WAYPOINTS};
pub use network::ProposalNetwork;
pub use remembered::SIMILARITY_SCALES;
