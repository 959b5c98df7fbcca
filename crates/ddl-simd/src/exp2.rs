//! Powers of two, computed with additions and multiplications.

#![expect(clippy::inline_always, reason = "the lanes must stay in registers")]

use crate::register::Register;

/// Magnitude of the smallest exponent of [`Register::exp2_each`]; smaller exponents are clamped.
pub const COST_LIMIT: f32 = 124.0;
/// Bound on the relative error of [`Register::exp2_each`].
pub const EXP2_ERROR: f64 = 3e-7;
/// Magnitude of the smallest exponent of [`wide_exp2_each`].
pub const COST_LIMIT_64: f64 = 900.0;
/// Bound on the relative error of [`wide_exp2_each`]: ten rounding units.
pub const EXP2_ERROR_64: f64 = 1.2e-15;
/// Bound on the relative error of [`wide_exp2_parts`]: 2.8 rounding units.
pub const EXP2_PARTS_ERROR: f64 = 3.1e-16;

/// Adding and subtracting 1.5 · 2^23 rounds a small number to an integer, which is in the low bits of the sum.
const ROUNDING: f32 = 12_582_912.0;
/// The same for `f64`: 1.5 · 2^52.
pub(crate) const WIDE_ROUNDING: f64 = 6_755_399_441_055_744.0;

/// Smallest exponent whose [`Simd::exp2`](crate::Simd::exp2) is not 0. Products of such a power and a number of at
/// least 2^−30 are normal; an operation on denormal numbers takes a hundred cycles.
const VANISHING_FROM: f32 = -96.0;

/// 2^f on [−1/2, 1/2] with the smallest maximum relative error (Remez exchange, 7.5e-8).
const NORMAL: [f32; 6] = [
    1.000_000_1,
    0.693_146_97,
    0.240_221_2,
    0.055_507_13,
    0.009_675_541,
    0.001_327_647_2,
];

/// 2^f on [−1/2, 1/2]: the polynomial with P(0) = 1 and the smallest maximum relative error (iteratively reweighted
/// least squares; 1.1e-7 with coefficients of f32).
#[expect(clippy::approx_constant, reason = "a fitted coefficient, not ln 2")]
const VANISHING: [f32; 6] = [
    1.0,
    0.693_147,
    0.240_222_42,
    0.055_507_336,
    0.009_671_513,
    0.001_326_472_7,
];

/// 2^f on [0, 1], degree 5 (Remez exchange, 7.5e-8).
#[cfg(target_arch = "x86_64")]
#[expect(clippy::excessive_precision, reason = "digits as printed by the Remez exchange")]
pub(crate) const UPWARD_POLYNOMIAL: [f32; 6] = [
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
    reason = "digits as printed by the Remez exchange"
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

/// [`Register::exp2_each`] for instruction sets without special instructions.
#[inline(always)]
pub(crate) fn normal<R: Register, const G: usize>(register: R, mut exponents: [R::Floats; G]) -> [R::Floats; G] {
    for exponent in &mut exponents {
        *exponent = register.max(*exponent, register.splat(-COST_LIMIT));
    }
    by_rounding(register, exponents, NORMAL)
}

/// [`Simd::exp2`](crate::Simd::exp2): the result at −127 is exactly 0, because P(0) = 1 and the biased exponent is 0.
#[inline(always)]
pub(crate) fn vanishing<R: Register, const G: usize>(register: R, mut exponents: [R::Floats; G]) -> [R::Floats; G] {
    let [smallest, vanished] = [register.splat(VANISHING_FROM), register.splat(-127.0)];
    for exponent in &mut exponents {
        *exponent = register.where_at_least(*exponent, smallest, *exponent, vanished);
    }
    by_rounding(register, exponents, VANISHING)
}

/// exponent = k + f with integer k and |f| ≤ 1/2: a polynomial gives 2^f, and k is added to its exponent.
#[inline(always)]
fn by_rounding<R: Register, const G: usize>(
    register: R,
    mut exponents: [R::Floats; G],
    coefficients: [f32; 6],
) -> [R::Floats; G] {
    let rounding = register.splat(ROUNDING);
    let mut fractions = exponents;
    for g in 0..G {
        let exponent = exponents[g];
        exponents[g] = register.add(exponent, rounding);
        fractions[g] = register.sub(exponent, register.sub(exponents[g], rounding));
    }
    let [lower @ .., highest] = coefficients;
    let mut powers = [register.splat(highest); G];
    for coefficient in lower.into_iter().rev() {
        for g in 0..G {
            powers[g] = register.mul_add(powers[g], fractions[g], register.splat(coefficient));
        }
    }
    for g in 0..G {
        powers[g] = register.scale(powers[g], exponents[g]);
    }
    powers
}

/// 2^exponent of several registers of `f64`, for exponents that are not positive.
///
/// # Numerics
/// The relative error is below [`EXP2_ERROR_64`]; every instruction set gives the same bits. Exponents below
/// −[`COST_LIMIT_64`] (and NaN) count as −[`COST_LIMIT_64`], so that no result is denormal.
#[inline(always)]
pub fn wide_exp2_each<R: Register, const G: usize>(register: R, mut exponents: [R::Wide; G]) -> [R::Wide; G] {
    let mut fractions = exponents;
    for g in 0..G {
        let exponent = register.wide_max(exponents[g], register.wide_splat(-COST_LIMIT_64));
        (exponents[g], fractions[g]) = register.wide_split(exponent);
    }
    let [lower @ .., highest] = WIDE_POLYNOMIAL;
    let mut powers = [register.wide_splat(highest); G];
    for coefficient in lower.into_iter().rev() {
        for g in 0..G {
            let product = register.wide_mul(powers[g], fractions[g]);
            powers[g] = register.wide_add(product, register.wide_splat(coefficient));
        }
    }
    for g in 0..G {
        powers[g] = register.wide_scale(powers[g], exponents[g]);
    }
    powers
}

/// 2^exponent as a factor from 2^−1/2 to 2^1/2 and an integer power of two: (factor, integer). |exponent| must be below
/// 2^51.
///
/// # Numerics
/// The products are fused: the relative error of the factor is below [`EXP2_PARTS_ERROR`], and the factor is exactly 1
/// for integers. Every instruction set gives the same bits, except the sign of an integer 0.
#[inline(always)]
pub fn wide_exp2_parts<R: Register>(register: R, exponent: R::Wide) -> (R::Wide, R::Wide) {
    let (integer, fraction) = register.wide_split(exponent);
    let squared = register.wide_mul(fraction, fraction);
    // Even and odd powers are summed separately, which halves the latency of a single chain.
    let [lower @ .., even, odd] = WIDE_POLYNOMIAL.map(|coefficient| register.wide_splat(coefficient));
    let mut sums = [even, odd];
    for pair in lower.as_chunks().0.iter().rev() {
        let [even, odd]: [_; 2] = *pair;
        sums = [
            register.wide_mul_add(sums[0], squared, even),
            register.wide_mul_add(sums[1], squared, odd),
        ];
    }
    let [even, odd] = sums;
    (register.wide_mul_add(odd, fraction, even), integer)
}
