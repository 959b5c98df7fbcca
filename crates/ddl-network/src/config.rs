//! Sizes of the networks, and how they are trained.

mod backbone_kind;
mod proposal;
mod range;
mod star;
mod training;
mod variant;

pub use backbone_kind::BackboneKind;
pub use proposal::{ProposalConfig, ProposalTraining};
pub use star::{NetworkFrame, StarConfig};
pub use training::{LearningRateSchedule, Objective, TrainingConfig};
pub use variant::Variant;
