//! Powers of two, from additions and multiplications.

#![expect(clippy::inline_always, reason = "the lanes must stay in registers")]

use super::lanes::Lanes;

/// Exponents below this count as this, and give 0.
const SMALLEST: f32 = -127.0;

/// Adding and subtracting 1.5 · 2^23 rounds a small number to an integer, which then sits in the low bits of the sum.
const ROUNDING: f32 = 12_582_912.0;

/// 2^f on [−1/2, 1/2]: of the polynomials of degree 5 with P(0) = 1 the one with the least largest relative error
/// (iteratively reweighted least squares; 1.1e-7 with coefficients of f32).
const POLYNOMIAL: [f32; 6] = [
    1.0,
    0.693_147,
    0.240_222_42,
    0.055_507_336,
    0.009_671_513,
    0.001_326_472_7,
];

/// 2^`exponent` for exponents that are not positive.
///
/// exponent = k + f with integer k and |f| ≤ 1/2: a polynomial gives 2^f, and k is added to its exponent.
///
/// # Numerics
/// The relative error is below 3e-7 down to −126. Below, the result lies in [0, 2^−125], and it is exactly 0 from −127
/// on (−∞ included): P(0) = 1 and a biased exponent of 0 leave no bit. NaN counts as −127.
#[inline(always)]
pub(crate) fn exp2<const FUSED: bool>(exponent: Lanes) -> Lanes {
    let rounding = Lanes::splat(ROUNDING);
    let exponent = exponent.max(Lanes::splat(SMALLEST));
    let integer = exponent.add(rounding);
    let fraction = exponent.sub(integer.sub(rounding));
    let mut power = Lanes::splat(POLYNOMIAL[POLYNOMIAL.len() - 1]);
    for degree in (0..POLYNOMIAL.len() - 1).rev() {
        power = power.mul_add::<FUSED>(fraction, Lanes::splat(POLYNOMIAL[degree]));
    }
    power.zip(integer, |power, integer| {
        f32::from_bits(power.to_bits().wrapping_add(integer.to_bits() << 23))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn one<const FUSED: bool>(exponent: f32) -> f32 {
        exp2::<FUSED>(Lanes::splat(exponent)).0[3]
    }

    /// Against the f64 of the standard library, on steps that hit every fraction many times.
    #[test]
    fn is_a_power_of_two_to_seven_digits() {
        for step in 0..2_000_000_u32 {
            let exponent = -126.0 * step as f32 / 2e6;
            let exact = f64::from(exponent).exp2();
            for power in [one::<false>(exponent), one::<true>(exponent)] {
                let error = (f64::from(power) - exact).abs() / exact;
                assert!(error < 3e-7, "2^{exponent}: {power}, error {error}");
            }
        }
    }

    #[test]
    fn is_one_at_zero_and_vanishes() {
        assert!(one::<true>(0.0).to_bits() == 1.0_f32.to_bits());
        for exponent in [-127.0, -127.3, -1e4, f32::NEG_INFINITY] {
            assert!(one::<true>(exponent).to_bits() == 0, "2^{exponent}");
        }
        for step in 0..=1000 {
            let power = one::<true>(-126.0 - step as f32 / 1000.0);
            assert!((0.0..=2.4e-38).contains(&power), "{step}: {power}");
        }
    }
}
