//! The networks behind the shared rollout. They turn the input of each time step into features; the output layer turns
//! features into the factors (a, b, c) of the metric, or into a position.

mod features;
mod perceptron;
mod star;

pub use features::{Backbone, output_layer};
pub use perceptron::Perceptron;
pub use star::Star;
