//! Powers of two in `f64`, with the same bits on every instruction set.

#![expect(clippy::inline_always, reason = "the lanes must stay in registers")]

use ddl_simd::Simd;
use fearless_simd::f64x8;
use fearless_simd::prelude::*;

/// Adding and subtracting 1.5 · 2^52 rounds a number to an integer, which is in the low bits of the sum.
const ROUNDING: f64 = 6_755_399_441_055_744.0;

/// 2^f on [−1/2, 1/2], degree 11 (Remez exchange, 3.1e-18).
#[expect(clippy::excessive_precision, clippy::approx_constant, reason = "digits as printed by the Remez exchange")]
const POLYNOMIAL: [f64; 12] = [
    1.0,
    0.693_147_180_559_945_330_461,
    0.240_226_506_959_101_562_046,
    0.055_504_108_664_819_921_483_0,
    0.009_618_129_107_588_335_083_32,
    0.001_333_355_814_678_995_032_25,
    0.000_154_035_304_625_146_130_257,
    0.000_015_252_733_489_960_804_600_1,
    0.000_001_321_543_308_959_462_903_69,
    1.017_819_803_332_852_766_16e-7,
    7.074_105_626_245_659_370_85e-9,
    4.435_280_944_610_336_161_06e-10,
];

/// 2^exponent as a factor from 2^−1/2 to 2^1/2 and an integer power of two: [factor, integer]. |exponent| must be below
/// 2^51.
///
/// # Numerics
/// The relative error of the factor is below 3.1e-16 (2.8 rounding units), and the factor is exactly 1 for integers.
#[inline(always)]
pub(crate) fn exp2_parts<S: Simd>(simd: S, exponent: f64x8<S>) -> [f64x8<S>; 2] {
    let integer = (exponent + ROUNDING) - ROUNDING;
    let fraction = exponent - integer;
    let squared = fraction * fraction;
    // Even and odd powers are summed separately, which halves the latency of a single chain.
    let [lower @ .., even, odd] = POLYNOMIAL;
    let mut sums = [even, odd].map(
        #[inline(always)]
        |coefficient| f64x8::splat(simd, coefficient),
    );
    for [even, odd] in lower.as_chunks().0.iter().rev() {
        sums = [sums[0].mul_add_precise(squared, *even), sums[1].mul_add_precise(squared, *odd)];
    }
    let [even, odd] = sums;
    [odd.mul_add_precise(fraction, even), integer]
}

/// number · 2^exponent for a positive normal number and an integer exponent of at least −2000. If the product is below
/// the normal numbers, the result is not above 2^−1022: it may be negative or NaN.
#[inline(always)]
pub(crate) fn times_power<S: Simd>(number: f64x8<S>, exponent: f64x8<S>) -> f64x8<S> {
    f64x8::from_bits(number.to_bits() + ((exponent + ROUNDING).to_bits() << 52))
}

#[cfg(test)]
mod tests {
    use ddl_simd::{Dispatch, InstructionSet, Kernel, Simd};
    use fearless_simd::f64x8;
    use fearless_simd::prelude::*;

    use super::{exp2_parts, times_power};

    /// Factors, integers, and their products.
    struct Parts<'a>(&'a [f64; 8], &'a mut [[f64; 8]; 3]);

    impl Kernel for Parts<'_> {
        #[inline]
        fn run<S: Simd>(self, simd: S) {
            let [factor, integer] = exp2_parts(simd, f64x8::load_array_ref(simd, self.0));
            factor.store_array(&mut self.1[0]);
            integer.store_array(&mut self.1[1]);
            times_power(factor, integer).store_array(&mut self.1[2]);
        }
    }

    fn on_each_set(exponents: [f64; 8]) -> Vec<[[f64; 8]; 3]> {
        let parts = |set| {
            let mut parts = [[0.0; 8]; 3];
            Dispatch::new(set).expect("available").run(Parts(&exponents, &mut parts));
            parts
        };
        InstructionSet::available().into_iter().map(parts).collect()
    }

    /// Compared with the power of the fraction by the standard library. Its own error, up to half a unit in the last
    /// place, hardly meets the largest one.
    #[test]
    fn parts_keep_the_error_bound_and_their_bits() {
        let mut worst = 0.0_f64;
        for i in 0..50_000_u32 {
            let exponents = std::array::from_fn(|l| -1.234_567e-3 * f64::from(i) * 3.0_f64.powi(l as i32) + l as f64);
            let results = on_each_set(exponents);
            for parts in &results {
                let [factors, integers, products] = parts;
                assert_eq!(parts.map(|lanes| lanes.map(f64::to_bits)), results[0].map(|lanes| lanes.map(f64::to_bits)));
                for l in 0..8 {
                    let fraction = exponents[l] - integers[l];
                    assert!(integers[l].fract() == 0.0 && fraction.abs() <= 0.5);
                    worst = worst.max((factors[l] / fraction.exp2() - 1.0).abs());
                    let expected = factors[l] * (integers[l] / 2.0).exp2().powi(2);
                    if exponents[l] > -1020.0 {
                        assert!((products[l] / expected - 1.0).abs() < 1e-12);
                    } else if exponents[l] > -2000.0 && expected < f64::MIN_POSITIVE {
                        // It may be NaN.
                        let above = products[l] > f64::MIN_POSITIVE;
                        assert!(!above, "2^{}: {}", exponents[l], products[l]);
                    }
                }
            }
        }
        assert!((5e-17..3.1e-16 + 3e-17).contains(&worst), "{worst:e}");
    }

    #[test]
    fn integers_are_exact() {
        let far = 2.0_f64.powi(51) - 1.0;
        let exponents = [0.0, -0.0, 1.0, -37.0, 1023.0, -1022.0, far, -far];
        for [factors, integers, _] in on_each_set(exponents) {
            assert_eq!((factors, integers), ([1.0; 8], exponents));
        }
    }
}
