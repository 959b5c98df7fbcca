//! Powers of two are within the stated error bounds on every instruction set.
#![allow(clippy::unwrap_used, reason = "a test may panic")]
#![expect(clippy::inline_always, reason = "compiled per instruction set")]

use ddl_simd::{Dispatch, InstructionSet, Kernel, LANES, Simd};

fn each_set(test: impl FnMut(Dispatch)) {
    InstructionSet::available().into_iter().map(|set| Dispatch::new(set).unwrap()).for_each(test);
}

struct Powers<'a>(&'a mut [[f32; LANES]]);

impl Kernel for Powers<'_> {
    #[inline(always)]
    fn run<S: Simd>(self, simd: S) {
        for lanes in self.0 {
            simd.store(simd.exp2(simd.load(lanes)), lanes);
        }
    }
}

fn powers(dispatch: Dispatch, exponents: &[f32]) -> Vec<f32> {
    let mut lanes = exponents.to_vec();
    lanes.resize(exponents.len().next_multiple_of(LANES), 0.0);
    dispatch.run(Powers(lanes.as_chunks_mut().0));
    lanes.truncate(exponents.len());
    lanes
}

/// Compared with the standard library in f64, on steps that cover every fraction many times.
#[test]
fn groups_are_powers_of_two_to_seven_digits() {
    let exponents: Vec<f32> = (0..2_000_000).map(|step| -96.0 * step as f32 / 2e6).collect();
    each_set(|dispatch| {
        let mut worst = 0.0_f64;
        for (exponent, power) in exponents.iter().zip(powers(dispatch, &exponents)) {
            let exact = f64::from(*exponent).exp2();
            worst = worst.max((f64::from(power) - exact).abs() / exact);
        }
        let set = dispatch.instruction_set();
        assert!((1e-8..3e-7).contains(&worst), "{set:?}: {worst:e}");
    });
}

#[test]
fn groups_are_one_at_zero_and_vanish() {
    each_set(|dispatch| {
        let set = dispatch.instruction_set();
        let below = f32::from_bits((-96.0_f32).to_bits() + 1);
        let last = powers(dispatch, &[-96.0])[0];
        assert!((f64::from(last) * 96_f64.exp2() - 1.0).abs() < 3e-7, "{set:?}: {last:e}");
        let ends = [0.0, below, -126.5, -127.0, -1e4, f32::NEG_INFINITY, f32::NAN];
        let bits: Vec<u32> = powers(dispatch, &ends).into_iter().map(f32::to_bits).collect();
        assert_eq!(bits, [1.0_f32.to_bits(), 0, 0, 0, 0, 0, 0], "{set:?}");
    });
}
