//! The networks behind the shared rollout.

mod features;
mod output_layer;
mod perceptron;
mod star;

pub use features::Backbone;
pub use output_layer::output_layer;
pub use perceptron::Perceptron;
pub use star::Star;
