//! The heavy parts of the network, computed by ourselves on the CPU.

pub(crate) mod attention;
pub(crate) mod feed_forward;
