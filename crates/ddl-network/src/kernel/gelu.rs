//! The activation of the proposal network: x Φ(x), with Φ the normal distribution (Hendrycks and Gimpel 2016).

use ddl_simd::{Dispatch, Floats, Kernel, LANES, Simd};
use fearless_simd::prelude::*;

/// erfc(z) = t (a₁ + t (a₂ + …)) exp(−z²) for z ≥ 0, t = 1 / (1 + p z), within 1.5e-7 (Abramowitz and Stegun 7.1.26).
const P: f32 = 0.327_591_1;
const A: [f32; 5] = [0.254_829_6, -0.284_496_74, 1.421_413_7, -1.453_152_1, 1.061_405_4];

/// Replaces every number x by x Φ(x).
/// The error is below 1e-6 for |x| up to 6, and below the rounding of x beyond. NaN stays NaN.
pub(crate) fn gelu(numbers: &mut [f32]) {
    Dispatch::detect().run(Gelu(numbers));
}

struct Gelu<'a>(&'a mut [f32]);

impl Kernel for Gelu<'_> {
    #[inline(always)]
    fn run<S: Simd>(self, simd: S) {
        let (chunks, rest) = self.0.as_chunks_mut::<LANES>();
        for lanes in chunks {
            simd.store(of_lanes(simd, simd.load(lanes)), lanes);
        }
        let mut lanes = [0.0; LANES];
        lanes[..rest.len()].copy_from_slice(rest);
        let y = of_lanes(simd, simd.load(&lanes));
        simd.store(y, &mut lanes);
        rest.copy_from_slice(&lanes[..rest.len()]);
    }
}

/// max(x, 0) − |x| erfc(|x| / √2) / 2.
#[inline(always)]
fn of_lanes<S: Simd>(simd: S, x: Floats<S>) -> Floats<S> {
    let zero = simd.splat(0.0);
    let size = x.max(zero - x);
    let z = size * std::f32::consts::FRAC_1_SQRT_2;
    let one = simd.splat(1.0);
    let t = one / z.mul_add(simd.splat(P), one);
    let mut polynomial = simd.splat(A[A.len() - 1]);
    for degree in (0..A.len() - 1).rev() {
        polynomial = polynomial.mul_add(t, simd.splat(A[degree]));
    }
    let exponent = z * z * (-std::f32::consts::LOG2_E);
    let erfc = polynomial * t * simd.exp2(exponent);
    let half = size * 0.5;
    zero.max(x) - half * erfc
}

#[cfg(test)]
mod tests {
    use super::*;

    /// x erfc(-x / √2) / 2 in double precision, with erfc from another program.
    const KNOWN: [(f32, f64); 9] = [
        (-6.0, -5.919_525_870_226e-9),
        (-3.0, -0.004_049_694_094_890),
        (-1.0, -0.158_655_253_931_457),
        (-0.25, -0.100_323_418_579_269),
        (0.0, 0.0),
        (0.25, 0.149_676_581_420_731),
        (1.0, 0.841_344_746_068_543),
        (3.0, 2.995_950_305_905_11),
        (50.0, 50.0),
    ];

    #[test]
    fn values_are_those_of_the_definition() {
        for count in [1, 9, 16, 33] {
            let example = |i: usize| KNOWN[i % KNOWN.len()];
            let mut numbers: Vec<f32> = (0..count).map(|i| example(i).0).collect();
            gelu(&mut numbers);
            for (i, y) in numbers.into_iter().enumerate() {
                assert!((f64::from(y) - example(i).1).abs() < 1e-6, "{:?}: {y}", example(i));
            }
        }
        let mut nan = [f32::NAN, 1.0];
        gelu(&mut nan);
        assert!(nan[0].is_nan() && nan[1] > 0.8);
    }
}
