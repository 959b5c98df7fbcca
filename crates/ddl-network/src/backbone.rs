//! The networks behind the shared rollout: from what pedestrians see to features, and from these to what shapes a step.

mod features;
mod perceptron;
mod star;

pub use features::{Backbone, output_layer};
pub use perceptron::Perceptron;
pub use star::Star;
