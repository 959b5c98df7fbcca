//! What the tests of several kernels share.

pub(super) mod attention;
pub(super) mod chance;
pub(super) mod numbers;
