//! The heavy parts of the network, computed by ourselves on the CPU.

mod feed_forward;

pub(crate) use feed_forward::{Dropout, FeedForward, Gradients};
