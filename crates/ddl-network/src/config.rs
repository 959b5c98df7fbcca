//! Sizes of the networks, and settings of their training.

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
