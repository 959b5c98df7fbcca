//! Powers of two, from additions and multiplications.

#![expect(clippy::inline_always, reason = "the lanes must stay in registers")]

use super::simd::Simd;

/// Exponents below this count as this, and give 0.
const SMALLEST: f32 = -127.0;

/// Adding and subtracting 1.5 · 2^23 rounds a small number to an integer, which then sits in the low bits of the sum.
const ROUNDING: f32 = 12_582_912.0;

/// 2^f on [−1/2, 1/2]: of the polynomials of degree 5 with P(0) = 1 the one with the least largest relative error
/// (iteratively reweighted least squares; 1.1e-7 with coefficients of f32).
#[expect(clippy::approx_constant, reason = "the fit, not ln 2")]
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
pub(super) fn exp2<S: Simd>(simd: S, exponent: S::Floats) -> S::Floats {
    let rounding = simd.splat(ROUNDING);
    let exponent = simd.max(exponent, simd.splat(SMALLEST));
    let integer = simd.add(exponent, rounding);
    let fraction = simd.sub(exponent, simd.sub(integer, rounding));
    let mut power = simd.splat(POLYNOMIAL[POLYNOMIAL.len() - 1]);
    for degree in (0..POLYNOMIAL.len() - 1).rev() {
        power = simd.mul_add(power, fraction, simd.splat(POLYNOMIAL[degree]));
    }
    simd.scale(power, integer)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kernel::instruction_set::{Dispatch, InstructionSet};
    use crate::kernel::simd::Kernel;

    struct Powers<'a>(&'a mut [[f32; 16]]);

    impl Kernel for Powers<'_> {
        #[inline(always)]
        fn run<S: Simd>(self, simd: S) {
            for lanes in self.0 {
                let power = exp2(simd, simd.load(lanes));
                simd.store(power, lanes);
            }
        }
    }

    fn powers(set: InstructionSet, exponents: &[f32]) -> Vec<f32> {
        let mut lanes = exponents.to_vec();
        lanes.resize(exponents.len().next_multiple_of(16), 0.0);
        Dispatch::new(set)
            .unwrap()
            .run(Powers(lanes.as_chunks_mut().0));
        lanes.truncate(exponents.len());
        lanes
    }

    /// Against the f64 of the standard library, on steps that hit every fraction many times.
    #[test]
    fn is_a_power_of_two_to_seven_digits() {
        let exponents: Vec<f32> = (0..2_000_000)
            .map(|step| -126.0 * step as f32 / 2e6)
            .collect();
        for set in InstructionSet::available() {
            for (exponent, power) in exponents.iter().zip(powers(set, &exponents)) {
                let exact = f64::from(*exponent).exp2();
                let error = (f64::from(power) - exact).abs() / exact;
                assert!(
                    error < 3e-7,
                    "{set:?}: 2^{exponent}: {power}, error {error}"
                );
            }
        }
    }

    #[test]
    fn is_one_at_zero_and_vanishes() {
        for set in InstructionSet::available() {
            let ends = [0.0, -127.0, -127.3, -1e4, f32::NEG_INFINITY, f32::NAN];
            let bits: Vec<u32> = powers(set, &ends)
                .iter()
                .map(|power| power.to_bits())
                .collect();
            assert_eq!(bits, [1.0_f32.to_bits(), 0, 0, 0, 0, 0], "{set:?}");
            let small: Vec<f32> = (0..=1000)
                .map(|step| -126.0 - step as f32 / 1000.0)
                .collect();
            for (exponent, power) in small.iter().zip(powers(set, &small)) {
                assert!(
                    (0.0..=2.4e-38).contains(&power),
                    "{set:?}: 2^{exponent}: {power}"
                );
            }
        }
    }
}
