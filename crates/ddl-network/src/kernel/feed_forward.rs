//! The feed-forward block of an encoder layer: two affine maps with `ReLU` and dropout between them.

mod backward;
mod block;
mod dropout;
mod forward;
mod hidden;
mod layer;
mod product;
#[cfg(test)]
mod tests;
mod tile;
mod weights;

pub(crate) use backward::Gradients;
pub(crate) use layer::FeedForward;
