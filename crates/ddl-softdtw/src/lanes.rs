//! The numbers of a strip that are computed together.

use ddl_simd::WIDE_LANES;

/// Number of cells computed together: neighbours on an antidiagonal, one per row.
pub(crate) const STRIP: usize = WIDE_LANES;
/// One number per row of a strip.
pub(crate) type Lanes = [f64; STRIP];
