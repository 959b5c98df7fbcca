#![doc = include_str!("../README.md")]
//!
//! ## Bands, sliding windows and batches
//!
//! Sequences may be `f32` for single pairs; indices and batches take `f64`:
//!
//! ```rust
//! use ddl_softdtw::{Band, Cost, SlidingIndex, SoftDtw, SoftDtwBatch};
//!
//! let dtw = SoftDtw::new(1.0, Cost::SquaredEuclidean)?;
//! let track = |phase: f64| (0..40).map(|i| [(f64::from(i) * 0.2 + phase).sin()]).collect::<Vec<_>>();
//!
//! // A band of half a step around the diagonal: only equal steps are matched.
//! let banded = dtw.with_band(Band::new(0));
//! let (x, y) = ([[0.0_f32], [1.0], [2.0]], [[0.5_f32], [1.0], [2.5]]);
//! assert!((banded.value(&x, &y)? - 0.5).abs() < 1e-6);
//!
//! // All windows of 8 steps that are followed by 12 more steps, so that their future is known.
//! let tracks = [track(0.0), track(0.7)];
//! let windows = SlidingIndex::build(&dtw, &tracks, 8, 12)?;
//! let found = windows.nearest(&tracks[1][5..13], 1)?;
//! assert_eq!((found[0].track, found[0].offset, found[0].distance), (1, 5, 0.0));
//!
//! // A loss over many sequences, and its gradient.
//! let batch = SoftDtwBatch::build(&dtw, &tracks)?;
//! let (loss, gradient) = batch.weighted_sum(&track(0.3), &[0.5, 0.5])?;
//! assert!(loss.is_finite() && gradient.len() == 40);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! ## How a single value stays exact and fast
//!
//! The recursion runs on R = exp(−r/γ), where the smoothed minimum is a sum. A cell needs one exponential, off the
//! critical path, and no logarithm. R is stored as a significand with a separate integer exponent, so no range of costs
//! underflows. All terms are positive, so nothing cancels. [`SoftDtw`] states a bound of the error, and
//! `tests/precision.rs` compares results with values of 60 decimal digits. `D(x, y)` equals `D(y, x)` to the last bit.
//!
//! Eight rows advance together along antidiagonals in plain safe loops. The loops are compiled for each instruction
//! set, and all give the same bits: products are fused everywhere, in software (slowly) on processors without the
//! instruction. If costs are small and sequences short, R stays in the range of `f64` and needs no
//! separate exponent; a bound of the costs decides this in advance. If costs exceed about 10¹⁵ γ, or if γ = 0, the
//! recursion runs in the log domain.
//!
//! ## How the search stays exact and fast
//!
//! The index stores the candidates in blocks of sixteen, one candidate per lane, in `f32`. They are scaled so that
//! exp(−cost/γ) is a power of two. A query runs the recursion on all lanes at once in the exponential domain, where the
//! smoothed minimum is one addition. It keeps every candidate whose score may belong to the n best. The `f32` scores
//! only preselect candidates (the sieve): a bound of their error is computed from the lengths, the dimension and the
//! size of the data. Every candidate within that bound of the n-th score is evaluated again in `f64`, eight pairs at
//! once. The `f64` values decide the set, its order and the returned distances. Ties are broken by the index of the
//! candidate.
//!
//! The `f64` values are also computed in the exponential domain, to 4e-14 γ. A pair beyond its range (a value above
//! 570 γ, or more than 180 steps) is evaluated in the log domain. Operations are rounded in the same order everywhere.
//! So the results, including the distances, have the same bits for every instruction set, every number of threads and
//! every batch of queries. A candidate that equals the query is at distance 0.
//!
//! Some searches evaluate every candidate in `f64`, which is slower. These are searches with a band, with the Euclidean
//! cost, with sequences of more than 32 steps, or with data so large that the bound is useless. The same holds if the
//! n-th neighbour is farther than about 57 γ (47 γ without fused multiplication). For γ = 0 all values are computed in
//! the log domain.
//!
//! The kernels are written once and compiled for three instruction sets (`ddl-simd`): AVX-512, AVX2 with fused
//! multiplication, and the baseline of the target. The instruction set is chosen when an index is built;
//! `SearchIndex::with_instruction_set` chooses another, for tests and measurements.
//!
//! ## Windows of long tracks
//!
//! Overlapping windows share most of their steps. So the similarities between the steps of a query and of a candidate
//! are computed once for all windows that contain them. [`SlidingIndex`] also shares the sums over paths. A block has
//! as many query steps as a window, and is cut at its last row. Every path of every window that starts in the block
//! crosses the cut. So one recursion up to the cut and one back from it serve all pairs of windows, and a pair costs a
//! few products. All terms are positive, so nothing cancels. The results are those of [`SearchIndex`] on the extracted
//! windows, to the last bit.
//!
//! ## Accuracy, and the cost of a batch
//!
//! The distances of the 100 nearest are within 6e-15 m²/s² of the log-domain values (28 queries of 7 and 8 steps,
//! `tests/recordings.rs`). Counted with callgrind, a pair of 7 / 8 steps takes 347 / 478 instructions with AVX2 and
//! 1050 / 1330 with portable code; the compiled loop of AVX-512 has about 56 / 68.
//!
//! A batch of 4,096 sequences of 8 steps takes 24 ns for a value and a gradient (AVX-512, fastest query; AVX2 36 ns,
//! portable 92 ns) where all pairs fit `f32`. For the velocities of pedestrians it takes 31 ns (AVX2 48, portable 172):
//! 8 % of the pairs are evaluated in `f64` (16 % in the portable kernel, whose range is smaller). Values are within
//! 5e-6 and gradients within 4e-6 of those of [`SoftDtw`].

mod alignment;
mod band;
mod batch;
mod blocks;
mod cost;
mod decision;
mod error;
mod gradient;
mod grid;
mod lanes;
mod log_domain;
mod range;
mod recursion;
mod refine;
mod scalar;
mod search;
mod select;
mod sieve;
mod sliding;
mod softmin;
mod value;
mod wavefront;
mod weight;

pub use band::Band;
pub use batch::{BatchGradients, SoftDtwBatch};
pub use cost::Cost;
pub use ddl_simd::InstructionSet;
pub use decision::Neighbour;
pub use error::{SearchError, SequenceRole, SoftDtwError};
pub use scalar::Scalar;
pub use search::SearchIndex;
pub use sliding::{SlidingError, SlidingIndex, WindowNeighbour};
pub use value::SoftDtw;
