//! Shared parts of the kernels' tests.

pub(super) mod attention;
pub(super) mod chance;
pub(super) mod numbers;
