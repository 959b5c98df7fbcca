//! Misses: pedestrians whose end no hypothesis comes near.
//!
//! ```text
//! miss_i = [ min_k FDE_{i,k} > d ]        miss rate = mean of miss_i, in [0, 1]
//! ```
//!
//! d is 0.5 m; the rates for 1 m and 2 m are measured beside it, because works differ.

/// The distance beyond which an end counts as missed, metres.
pub const MISS_DISTANCE: f64 = 0.5;
/// It, and the distances of other works; metres.
pub const MISS_DISTANCES: [f64; 3] = [MISS_DISTANCE, 1.0, 2.0];
