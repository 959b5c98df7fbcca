//! Sizes of the networks, and how they are trained.

mod memory;
mod proposal;
mod range;
mod star;
mod training;
mod variant;

pub use memory::{MemoryConfig, MemoryTraining};
pub use proposal::{ProposalConfig, ProposalTraining};
pub use star::{NetworkFrame, StarConfig};
pub use training::{LearningRateSchedule, Objective, TrainingConfig};
pub use variant::{BackboneKind, Variant};
