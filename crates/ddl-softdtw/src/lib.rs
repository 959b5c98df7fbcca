#![doc = include_str!("../README.md")]
//!
//! ## How a single value stays exact and fast
//!
//! The recursion runs on R = exp(−r/γ), where the smoothed minimum is a sum. A cell needs one exponential, off the
//! critical path, and no logarithm. R is stored as a significand with a separate integer exponent, so no range of costs
//! underflows. All terms are positive, so nothing cancels. [`SoftDtw`] states a bound of the error, and
//! `src/laws/precision.rs` compares results with values of 60 decimal digits. `D(x, y)` equals `D(y, x)` to the last
//! bit.
//!
//! Eight rows advance together along antidiagonals. The loops are compiled for each instruction set, and all give the
//! same bits: products are fused everywhere, in software (slowly) on processors without the instruction. If costs may
//! exceed about 10¹⁵ γ, or if γ = 0, the recursion runs in the log domain.
//!
//! ## How the search stays exact and fast
//!
//! The index stores the candidates in blocks of sixteen, one candidate per lane, in `f32`. They are scaled so that
//! exp(−cost/γ) is a power of two. A query runs the recursion on all lanes at once in the exponential domain, where the
//! smoothed minimum is one addition. It keeps every candidate whose score may belong to the n best. The `f32` scores
//! only preselect candidates (the sieve): a bound of their error is computed from the lengths, the dimension and the
//! size of the data. Every candidate within that bound of the n-th score is evaluated again in `f64`, as a single
//! value. The `f64` values decide the set, its order and the returned distances. Ties are broken by the index.
//! So the results, including the distances, have the same bits for every instruction set, every number of threads and
//! every batch of queries. A candidate that equals the query is at distance 0.
//!
//! Some searches evaluate every candidate in `f64`, which is slower. These are searches with sequences of more than
//! 32 steps, or with data so large that the bound is useless. The same holds if the n-th neighbour is farther than
//! about 57 γ. For γ = 0 all values are computed in the log domain.
//!
//! The kernels are written once and compiled for three instruction sets (`ddl-simd`): AVX-512, AVX2 with fused
//! multiplication, and the baseline of the target. The fastest of the machine is taken.
//!
//! ## Accuracy and cost
//!
//! Counted with callgrind, a pair of 7 / 8 steps takes 347 / 478 instructions with AVX2 and 1050 / 1330 with portable
//! code.

mod backward;
mod blocks;
mod error;
mod exp2;
mod forward;
mod gradient;
mod grid;
#[cfg(test)]
mod laws;
mod log_domain;
mod range;
mod recursion;
mod search;
mod select;
mod sieve;
mod softmin;
mod value;
mod weight;

pub use error::{SearchError, SoftDtwError};
pub use search::{Neighbour, SearchIndex};
pub use value::SoftDtw;
