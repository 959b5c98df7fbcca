//! 2^−t on a few numbers at once, as an integer power of two and a factor near 1.
#![expect(
    clippy::inline_always,
    reason = "the lanes stay in registers only when what works on them is inlined"
)]

use ddl_simd::Register;

/// Number of cells computed together: neighbours on an antidiagonal, one per row.
pub(crate) const STRIP: usize = 8;
pub(crate) type Lanes = [f64; STRIP];

/// Adding and subtracting 1.5 · 2^52 rounds a number below 2^51 to an integer, which is in the low bits of the sum.
pub(crate) const ROUNDING: f64 = 6_755_399_441_055_744.0;

/// (2^−f − 1) / f on [−1/2, 1/2]: the polynomial of degree 10 for which 2^−f has the smallest maximum relative error,
/// 4.3e-17.
const POLYNOMIAL: [f64; 11] = [
    -0.693_147_180_559_945_7,
    0.240_226_506_959_100_97,
    -0.055_504_108_664_790_39,
    0.009_618_129_107_607_003,
    -0.001_333_355_815_343_996_6,
    0.000_154_035_304_415_721_3,
    -1.525_272_738_519_386_8e-5,
    1.321_544_267_532_982_3e-6,
    -1.018_064_765_923_413_9e-7,
    7.072_570_412_814_423e-9,
    -4.078_071_929_588_337e-10,
];

/// ([`ROUNDING`] − k, 2^−f) with k + f = t, k an integer and |f| ≤ 1/2, for 0 ≤ t < 2^51; exactly 1 for t = 0. Relative
/// error of 2^−f: at most 2.3e-16.
#[inline(always)]
pub(crate) fn exp2_minus<S: Register>(simd: S, t: S::Wide) -> (S::Wide, S::Wide) {
    let rounding = simd.wide_splat(ROUNDING);
    let minus = simd.wide_sub(rounding, t);
    let f = simd.wide_sub(t, simd.wide_sub(rounding, minus));
    let ff = simd.wide_mul(f, f);
    // Even and odd powers are summed separately, which halves the latency of a single chain.
    let mut sums = [simd.wide_splat(POLYNOMIAL[10]), simd.wide_splat(POLYNOMIAL[9])];
    for (i, coefficient) in POLYNOMIAL.into_iter().enumerate().take(9).rev() {
        let product = simd.wide_mul(sums[i % 2], ff);
        sums[i % 2] = simd.wide_add(product, simd.wide_splat(coefficient));
    }
    let [even, odd] = sums;
    let quotient = simd.wide_add(even, simd.wide_mul(odd, f));
    let power = simd.wide_add(simd.wide_mul(quotient, f), simd.wide_splat(1.0));
    (minus, power)
}

#[cfg(test)]
mod tests {
    #![expect(clippy::float_cmp, reason = "exact values are what is claimed")]

    use ddl_simd::{Dispatch, Register, RegisterKernel};

    use super::{ROUNDING, STRIP, exp2_minus};

    struct Minus(f64);

    impl RegisterKernel for Minus {
        type Output = (f64, f64);

        #[inline(always)]
        fn run<S: Register>(self, simd: S) -> (f64, f64) {
            let (minus, power) = exp2_minus(simd, simd.wide_splat(self.0));
            let mut results = [[0.0; STRIP]; 2];
            simd.wide_store(minus, &mut results[0], 0);
            simd.wide_store(power, &mut results[1], 0);
            (ROUNDING - results[0][0], results[1][0])
        }
    }

    #[test]
    fn it_is_exp2_to_two_units_of_roundoff() {
        let mut worst = 0.0_f64;
        for i in 0..400_000_u32 {
            let t = f64::from(i) * 1.234_567e-3;
            let (whole, power) = Dispatch::detect().run_on_registers(Minus(t));
            assert!(whole == whole.round() && (t - whole).abs() <= 0.5);
            // The exp2 of the library adds an error of up to half a unit in the last place.
            worst = worst.max((power / (whole - t).exp2() - 1.0).abs());
        }
        assert!((5e-17..3.4e-16).contains(&worst), "{worst:e}");
    }

    #[test]
    fn whole_numbers_are_exact_up_to_the_largest() {
        for t in [0.0, 1.0, 37.0, 2.0_f64.powi(51) - 1.0] {
            let result = Dispatch::detect().run_on_registers(Minus(t));
            assert_eq!(result, (t, 1.0));
        }
    }
}
