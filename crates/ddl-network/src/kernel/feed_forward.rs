//! The feed-forward block of an encoder layer: two affine maps with `ReLU` and dropout between them.

mod backward;
mod dropout;
mod forward;
mod layer;
#[cfg(test)]
mod tests;

pub(crate) use backward::LayerGradients;
pub(crate) use layer::FeedForward;
