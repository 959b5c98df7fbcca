//! Constants of walking that several parts of a forecast read.

/// Speed (m/s) of a fast walk. Recordings hold few pedestrians above it.
pub const FAST_WALK: f64 = 2.0;
/// Mean length (m) of the second differences of a track, one every 0.4 s, above which they are mostly errors of its
/// positions: the weight of a last step falls by a factor e there.
pub const JITTER: f64 = 0.06;
/// Number of last steps over which a present velocity is averaged.
pub const RECENT_STEPS: usize = 3;
