//! How much of a long work is done.

/// Steps, windows or pedestrians done, and in total.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct WorkDone {
    /// Done so far.
    pub done: u64,
    /// In total.
    pub total: u64,
}
