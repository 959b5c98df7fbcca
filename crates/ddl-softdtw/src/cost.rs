//! The cost of matching one step of `x` with one step of `y`.
#![expect(
    clippy::inline_always,
    reason = "the lanes stay in registers only when what works on them is inlined"
)]

use ddl_simd::Register;

use crate::lanes::{Lanes, STRIP};
use crate::scalar::{Scalar, widened};

/// Distance between two steps: an entry of the cost matrix Δ(x, y).
///
/// For sequences in metres (or m/s) the squared cost is in m² (or m²/s²), and gamma has the unit of the cost.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Cost {
    /// |a − b|², what Cuturi & Blondel (2017) use and what the published goal estimator computes.
    #[default]
    SquaredEuclidean,
    /// |a − b|, what the text of the DDL paper says.
    Euclidean,
}

impl Cost {
    /// Cost of matching step `a` with step `b`; never negative, infinite when it exceeds the range of the number type.
    #[must_use]
    pub fn between<T: Scalar, const D: usize>(self, a: &[T; D], b: &[T; D]) -> T {
        let (a, b) = (&widened(a), &widened(b));
        T::rounded(match self {
            Self::SquaredEuclidean => Squared.between(a, b),
            Self::Euclidean => Length.between(a, b),
        })
    }
}

/// A cost as a type, so that the loops over cells are compiled for it.
pub(crate) trait Metric: Copy {
    fn between<const D: usize>(self, a: &[f64; D], b: &[f64; D]) -> f64;

    /// Derivative of the cost with respect to `a`; that with respect to `b` is its negative.
    fn slope<const D: usize>(self, a: &[f64; D], b: &[f64; D]) -> [f64; D];

    /// Factor between the derivatives of the cost and the results of [`slopes`](Self::slopes).
    const SLOPE: f64;

    /// The costs of several pairs of steps: [`between`](Self::between) up to rounding, because products are fused, and
    /// even and odd components are summed separately.
    fn of_lanes<S: Register, const D: usize>(self, simd: S, a: &[Lanes; D], b: [&Lanes; D]) -> Lanes;

    /// [`slope`](Self::slope) of each cost, divided by [`SLOPE`](Self::SLOPE).
    fn slopes<S: Register, const D: usize>(self, simd: S, a: &[Lanes; D], b: [&Lanes; D]) -> [Lanes; D];
}

#[derive(Clone, Copy)]
pub(crate) struct Squared;

#[derive(Clone, Copy)]
pub(crate) struct Length;

impl Metric for Squared {
    const SLOPE: f64 = 2.0;

    #[inline(always)]
    fn between<const D: usize>(self, a: &[f64; D], b: &[f64; D]) -> f64 {
        let mut sum = 0.0;
        for k in 0..D {
            sum += (a[k] - b[k]) * (a[k] - b[k]);
        }
        sum
    }

    fn slope<const D: usize>(self, a: &[f64; D], b: &[f64; D]) -> [f64; D] {
        std::array::from_fn(|k| 2.0 * (a[k] - b[k]))
    }

    #[inline(always)]
    fn of_lanes<S: Register, const D: usize>(self, simd: S, a: &[Lanes; D], b: [&Lanes; D]) -> Lanes {
        let mut sums = [0.0; STRIP];
        for part in 0..S::PARTS {
            // Even and odd components are summed separately, which halves the latency of a single chain.
            let mut halves = [simd.wide_splat(0.0); 2];
            for k in 0..D {
                let difference = simd.wide_sub(simd.wide_load(&a[k], part), simd.wide_load(b[k], part));
                halves[k % 2] = if k < 2 {
                    simd.wide_mul(difference, difference)
                } else {
                    simd.wide_mul_add(difference, difference, halves[k % 2])
                };
            }
            let sum = if D > 1 {
                simd.wide_add(halves[0], halves[1])
            } else {
                halves[0]
            };
            simd.wide_store(sum, &mut sums, part);
        }
        sums
    }

    #[inline(always)]
    fn slopes<S: Register, const D: usize>(self, simd: S, a: &[Lanes; D], b: [&Lanes; D]) -> [Lanes; D] {
        let mut slopes = [[0.0; STRIP]; D];
        for k in 0..D {
            for part in 0..S::PARTS {
                let difference = simd.wide_sub(simd.wide_load(&a[k], part), simd.wide_load(b[k], part));
                simd.wide_store(difference, &mut slopes[k], part);
            }
        }
        slopes
    }
}

impl Metric for Length {
    const SLOPE: f64 = 1.0;

    #[inline(always)]
    fn between<const D: usize>(self, a: &[f64; D], b: &[f64; D]) -> f64 {
        let squared = Squared.between(a, b);
        if is_plain(squared) {
            squared.sqrt()
        } else {
            scaled_length(a, b)
        }
    }

    /// At `a == b` there is no derivative; 0 is the subgradient with the smallest norm.
    fn slope<const D: usize>(self, a: &[f64; D], b: &[f64; D]) -> [f64; D] {
        let length = self.between(a, b);
        std::array::from_fn(|k| if length > 0.0 { (a[k] - b[k]) / length } else { 0.0 })
    }

    #[inline(always)]
    fn of_lanes<S: Register, const D: usize>(self, simd: S, a: &[Lanes; D], b: [&Lanes; D]) -> Lanes {
        let squared = Squared.of_lanes(simd, a, b);
        let mut lengths = [0.0; STRIP];
        for l in 0..STRIP {
            lengths[l] = squared[l].sqrt();
        }
        if !squared.iter().all(|&squared| is_plain(squared)) {
            lengths = scaled_lengths(a, b, squared);
        }
        lengths
    }

    #[inline(always)]
    fn slopes<S: Register, const D: usize>(self, simd: S, a: &[Lanes; D], b: [&Lanes; D]) -> [Lanes; D] {
        let lengths = self.of_lanes(simd, a, b);
        let mut slopes = [[0.0; STRIP]; D];
        for k in 0..D {
            for l in 0..STRIP {
                if lengths[l] > 0.0 {
                    slopes[k][l] = (a[k][l] - b[k][l]) / lengths[l];
                }
            }
        }
        slopes
    }
}

/// Squares overflow above 1e154 and lose digits below 1e-154; in these cases the differences are scaled first.
#[inline(always)]
fn is_plain(squared: f64) -> bool {
    (1e-280..=1e280).contains(&squared)
}

#[cold]
fn scaled_lengths<const D: usize>(a: &[Lanes; D], b: [&Lanes; D], squared: Lanes) -> Lanes {
    std::array::from_fn(|l| {
        if is_plain(squared[l]) {
            squared[l].sqrt()
        } else {
            scaled_length(&a.map(|lanes| lanes[l]), &b.map(|lanes| lanes[l]))
        }
    })
}

#[cold]
fn scaled_length<const D: usize>(a: &[f64; D], b: &[f64; D]) -> f64 {
    let differences = || a.iter().zip(b).map(|(a, b)| (a - b).abs());
    let largest = differences().fold(0.0, f64::max);
    if largest == 0.0 || largest.is_infinite() {
        return largest;
    }
    largest * differences().map(|d| (d / largest).powi(2)).sum::<f64>().sqrt()
}

#[cfg(test)]
mod tests {
    #![expect(clippy::float_cmp, reason = "exact values are what is claimed")]

    use super::{Cost, Length, Metric};

    #[test]
    fn the_euclidean_cost_neither_overflows_nor_underflows() {
        for scale in [1e-200_f64, 1.0, 1e200] {
            let length: f64 = Cost::Euclidean.between(&[3.0 * scale, 0.0], &[0.0, 4.0 * scale]);
            assert!((length / (5.0 * scale) - 1.0).abs() < 1e-15, "{length}");
        }
        let smallest = f64::from_bits(1);
        assert_eq!(Cost::Euclidean.between(&[smallest], &[0.0]), smallest);
        assert_eq!(Length.slope(&[smallest], &[0.0]), [1.0]);
        assert_eq!(Length.slope(&[2.0, 3.0], &[2.0, 3.0]), [0.0; 2]);
        assert_eq!(Cost::Euclidean.between(&[1.0; 3], &[1.0; 3]), 0.0);
        assert_eq!(Cost::Euclidean.between(&[3.0e30_f32, 0.0], &[0.0, 4.0e30]), 5.0e30);
    }
}
