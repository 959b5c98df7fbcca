//! Powers of two, computed with additions and multiplications.

#![expect(clippy::inline_always, reason = "the lanes must stay in registers")]

use fearless_simd::{Simd, SimdFloat};

/// Adding and subtracting 1.5 · 2^23 rounds a small number to an integer, which is in the low bits of the sum.
const ROUNDING: f32 = 12_582_912.0;

/// 2^f on [−1/2, 1/2]: the polynomial with P(0) = 1 and the smallest maximum relative error (iteratively reweighted
/// least squares; 1.1e-7 with coefficients of f32).
#[expect(clippy::approx_constant, reason = "a fitted coefficient, not ln 2")]
const POLYNOMIAL: [f32; 6] = [1.0, 0.693_147, 0.240_222_42, 0.055_507_336, 0.009_671_513, 0.001_326_472_7];

/// 2^exponent of several vectors, for exponents from −126 to 127. The vectors are processed stage by stage, so that the
/// processor can overlap them.
///
/// # Numerics
/// The relative error is below 3e-7. The result is exactly 1 at 0 and exactly 0 at −127.
#[inline(always)]
pub fn exp2_each<S: Simd, V: SimdFloat<S, Element = f32>, const G: usize>(simd: S, mut exponents: [V; G]) -> [V; G] {
    // exponent = k + f with integer k and |f| ≤ 1/2: a polynomial gives 2^f, and k is added to its exponent. At −127
    // the biased exponent is 0, and so is the fraction, because P(0) = 1.
    let mut fractions = exponents;
    for g in 0..G {
        let exponent = exponents[g];
        exponents[g] = exponent + ROUNDING;
        fractions[g] = exponent - (exponents[g] - ROUNDING);
    }
    let [lower @ .., highest] = POLYNOMIAL;
    let mut powers = [V::splat(simd, highest); G];
    for coefficient in lower.into_iter().rev() {
        for g in 0..G {
            powers[g] = powers[g].mul_add(fractions[g], coefficient);
        }
    }
    for g in 0..G {
        powers[g] = V::from_bits(powers[g].to_bits() + (exponents[g].to_bits() << 23));
    }
    powers
}
