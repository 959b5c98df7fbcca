//! A small network that proposes where a pedestrian will be at the end of the horizon.
//! It sees one pedestrian in its own frame and those nearby. An ensemble of members, each with K ends, is trained so that
//! the nearest of the K ends comes close to the true one ("winner takes all").

mod ends;
mod layers;
mod member;
mod network;
mod remembered;
mod seen;

pub use ends::{END_UNIT, PedestrianView, ProposalExample, ProposeEnds, ProposedEnds};
pub use layers::{AttentionLayers, MemberAffine, ProposalLayers, ReadoutLayers, WAYPOINTS};
pub use network::ProposalNetwork;
pub use remembered::{LIKENESSES, REMEMBERED_FEATURES};
pub use seen::{NEIGHBOUR_FEATURES, RECENT};
