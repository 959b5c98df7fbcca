//! Powers of two, from additions and multiplications.

#![expect(clippy::inline_always, reason = "the lanes must stay in registers")]

use super::Simd;

/// Largest cost of a cell, log2 units: a larger one counts as this.
pub(crate) const COST_LIMIT: f32 = 124.0;
/// Bound on the relative error of [`Simd::exp2`].
pub(crate) const EXP2_ERROR: f64 = 3e-7;
/// Largest cost of a cell in `f64`, log2 units.
pub(crate) const COST_LIMIT_64: f64 = 900.0;
/// Bound on the relative error of [`Simd::wide_exp2_each`], ten units of rounding.
pub(crate) const EXP2_ERROR_64: f64 = 1.2e-15;

/// Adding and subtracting 1.5 · 2^23 rounds a small number to an integer, which then sits in the low bits of the sum.
const ROUNDING: f32 = 12_582_912.0;
/// 1.5 · 2^52, likewise.
const WIDE_ROUNDING: f64 = 6_755_399_441_055_744.0;

/// 2^f on [−1/2, 1/2]: the polynomial of degree 5 with the least largest relative error (Remez exchange, 7.5e-8).
const POLYNOMIAL: [f32; 6] = [
    1.000_000_1,
    0.693_146_97,
    0.240_221_2,
    0.055_507_13,
    0.009_675_541,
    0.001_327_647_2,
];

/// 2^f on [0, 1], degree 5 (Remez exchange, 7.5e-8).
#[cfg(target_arch = "x86_64")]
#[expect(clippy::excessive_precision, reason = "as the exchange printed them")]
pub(super) const UPWARD_POLYNOMIAL: [f32; 6] = [
    0.999_999_9,
    0.693_153_07,
    0.240_153_62,
    0.055_826_318,
    0.008_989_34,
    0.001_877_576_7,
];

/// 2^f on [−1/2, 1/2], degree 11 (Remez exchange, 3.1e-18).
#[expect(
    clippy::excessive_precision,
    clippy::approx_constant,
    reason = "as the exchange printed them"
)]
const WIDE_POLYNOMIAL: [f64; 12] = [
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

/// exponent = k + f with integer k and |f| ≤ 1/2: a polynomial gives 2^f, and k is added to its exponent.
#[inline(always)]
pub(super) fn by_rounding<S: Simd, const G: usize>(
    simd: S,
    mut exponents: [S::Narrow; G],
) -> [S::Narrow; G] {
    let rounding = simd.splat(ROUNDING);
    let mut fractions = exponents;
    for g in 0..G {
        let exponent = simd.max(exponents[g], simd.splat(-COST_LIMIT));
        exponents[g] = simd.add(exponent, rounding);
        fractions[g] = simd.sub(exponent, simd.sub(exponents[g], rounding));
    }
    let [lower @ .., highest] = POLYNOMIAL;
    let mut powers = [simd.splat(highest); G];
    for coefficient in lower.into_iter().rev() {
        for g in 0..G {
            powers[g] = simd.mul_add(powers[g], fractions[g], simd.splat(coefficient));
        }
    }
    for g in 0..G {
        powers[g] = simd.scale(powers[g], exponents[g]);
    }
    powers
}

#[inline(always)]
pub(super) fn wide_by_rounding<S: Simd, const G: usize>(
    simd: S,
    mut exponents: [S::Wide; G],
) -> [S::Wide; G] {
    let rounding = simd.wide_splat(WIDE_ROUNDING);
    let mut fractions = exponents;
    for g in 0..G {
        let exponent = simd.wide_max(exponents[g], simd.wide_splat(-COST_LIMIT_64));
        exponents[g] = simd.wide_add(exponent, rounding);
        fractions[g] = simd.wide_sub(exponent, simd.wide_sub(exponents[g], rounding));
    }
    let [lower @ .., highest] = WIDE_POLYNOMIAL;
    let mut powers = [simd.wide_splat(highest); G];
    for coefficient in lower.into_iter().rev() {
        for g in 0..G {
            let product = simd.wide_mul(powers[g], fractions[g]);
            powers[g] = simd.wide_add(product, simd.wide_splat(coefficient));
        }
    }
    for g in 0..G {
        powers[g] = simd.wide_scale(powers[g], exponents[g]);
    }
    powers
}
