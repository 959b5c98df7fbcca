//! 2^−t on a few numbers at once, as an integer power of two and a factor near 1.
#![expect(
    clippy::inline_always,
    reason = "the lanes stay in registers only when what works on them is inlined"
)]

/// Cells computed together: neighbours on an antidiagonal, one a row.
pub(crate) const STRIP: usize = 8;
pub(crate) type Lanes = [f64; STRIP];

/// The lanes moved down by one row, `top` above them.
#[inline(always)]
pub(crate) fn below<T: Copy>(lanes: &[T; STRIP], top: T) -> [T; STRIP] {
    // Taken apart and put together, so that they are moved within registers.
    let [a, b, c, d, e, f, g, _] = *lanes;
    [top, a, b, c, d, e, f, g]
}

/// The lanes moved up by one row, `bottom` below them.
#[inline(always)]
pub(crate) fn above<T: Copy>(lanes: &[T; STRIP], bottom: T) -> [T; STRIP] {
    let [_, b, c, d, e, f, g, h] = *lanes;
    [b, c, d, e, f, g, h, bottom]
}

/// Adding and subtracting 1.5 · 2^52 rounds a number below 2^51 to an integer, which then sits in the low bits of the
/// sum.
pub(crate) const ROUNDING: f64 = 6_755_399_441_055_744.0;

/// (2^−f − 1) / f on [−1/2, 1/2]: the polynomial of degree 10 for which 2^−f has the least largest relative error,
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

/// (k, 2^−f) with k + f = t, k an integer and |f| ≤ 1/2, for 0 ≤ t < 2^51; exactly (0, 1) for t = 0. Relative error of
/// 2^−f: at most 2.3e-16.
#[inline(always)]
pub(crate) fn exp2_minus(t: &Lanes) -> (Lanes, Lanes) {
    let mut whole = [0.0; STRIP];
    let mut power = [0.0; STRIP];
    for l in 0..STRIP {
        whole[l] = (t[l] + ROUNDING) - ROUNDING;
        let f = t[l] - whole[l];
        let ff = f * f;
        let p = &POLYNOMIAL;
        // Even and odd powers apart: half the latency of one chain.
        let even = ((((p[10] * ff + p[8]) * ff + p[6]) * ff + p[4]) * ff + p[2]) * ff + p[0];
        let odd = (((p[9] * ff + p[7]) * ff + p[5]) * ff + p[3]) * ff + p[1];
        power[l] = (even + odd * f) * f + 1.0;
    }
    (whole, power)
}

#[cfg(test)]
mod tests {
    #![expect(clippy::float_cmp, reason = "exact values are what is claimed")]

    use super::{STRIP, exp2_minus};

    #[test]
    fn it_is_exp2_to_two_units_of_roundoff() {
        let mut worst = 0.0_f64;
        for i in 0..400_000_u32 {
            let t = f64::from(i) * 1.234_567e-3;
            let ([whole, ..], [power, ..]) = exp2_minus(&[t; STRIP]);
            assert!(whole == whole.round() && (t - whole).abs() <= 0.5);
            // The library's own exp2 errs by up to half a unit in the last place more.
            worst = worst.max((power / (whole - t).exp2() - 1.0).abs());
        }
        assert!((5e-17..3.4e-16).contains(&worst), "{worst:e}");
    }

    #[test]
    fn whole_numbers_are_exact_up_to_the_largest() {
        for t in [0.0, 1.0, 37.0, 2.0_f64.powi(51) - 1.0] {
            assert_eq!(exp2_minus(&[t; STRIP]), ([t; STRIP], [1.0; STRIP]));
        }
    }
}
