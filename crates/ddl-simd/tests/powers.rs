//! Powers of two are within the stated error bounds on every instruction set.
#![allow(clippy::unwrap_used, reason = "a test may panic")]
#![expect(clippy::inline_always, reason = "compiled per instruction set")]

use ddl_simd::{
    COST_LIMIT, COST_LIMIT_64, Dispatch, EXP2_ERROR, EXP2_ERROR_64, EXP2_PARTS_ERROR, InstructionSet, Kernel, LANES,
    Register, RegisterKernel, Simd, WIDE_LANES, wide_exp2_each, wide_exp2_parts,
};

type Narrow = [f32; LANES];
type Wide = [f64; WIDE_LANES];

fn each_set(test: impl FnMut(Dispatch)) {
    let sets = InstructionSet::available().into_iter();
    sets.map(|set| Dispatch::new(set).unwrap()).for_each(test);
}

struct Exp2<'a>(&'a mut Narrow, &'a mut Wide);

impl RegisterKernel for Exp2<'_> {
    type Output = ();

    #[inline(always)]
    fn run<R: Register>(self, register: R) {
        for part in 0..R::PARTS {
            let power = register.exp2(register.load(self.0, part));
            register.store(power, self.0, part);
            let [power] = wide_exp2_each(register, [register.wide_load(self.1, part)]);
            register.wide_store(power, self.1, part);
        }
    }
}

#[test]
fn registers_keep_the_error_bound_over_the_whole_range() {
    each_set(|dispatch| {
        let steps = 40_000;
        let mut worst = 0.0_f64;
        for i in 0..=steps {
            let exponents: Narrow = std::array::from_fn(|l| {
                let at = (f64::from(i) + l as f64 / LANES as f64) / f64::from(steps);
                -COST_LIMIT * at.min(1.0) as f32
            });
            let mut powers = exponents;
            dispatch.run_on_registers(Exp2(&mut powers, &mut [0.0; WIDE_LANES]));
            for (power, exponent) in powers.iter().zip(exponents) {
                let exact = f64::from(exponent).exp2();
                worst = worst.max((f64::from(*power) / exact - 1.0).abs());
            }
        }
        let set = dispatch.instruction_set();
        assert!(worst < EXP2_ERROR, "{set}: {worst:e}");
        assert!(worst > 1e-8, "{set}: implausibly small error {worst:e}");
    });
}

#[test]
fn wide_ones_keep_the_error_bound_and_their_bits() {
    let steps = 60_000;
    for i in 0..=steps {
        let exponents: Wide = std::array::from_fn(|l| {
            let at = (f64::from(i) + l as f64 / WIDE_LANES as f64) / f64::from(steps);
            // Dense near 0, where the exponents of the nearest candidates are.
            -COST_LIMIT_64 * at.min(1.0).powi(3)
        });
        let mut bits: Option<[u64; WIDE_LANES]> = None;
        each_set(|dispatch| {
            let mut powers = exponents;
            dispatch.run_on_registers(Exp2(&mut [0.0; LANES], &mut powers));
            for (power, exponent) in powers.iter().zip(exponents) {
                let error = (power / exponent.exp2() - 1.0).abs();
                assert!(error < EXP2_ERROR_64, "2^{exponent}: {error:e}");
            }
            let found = powers.map(f64::to_bits);
            let set = dispatch.instruction_set();
            assert_eq!(*bits.get_or_insert(found), found, "{set}");
        });
    }
}

/// Factors and integers.
struct Parts<'a>(&'a Wide);

impl RegisterKernel for Parts<'_> {
    type Output = (Wide, Wide);

    #[inline(always)]
    fn run<R: Register>(self, register: R) -> (Wide, Wide) {
        let (mut factors, mut integers) = ([0.0; WIDE_LANES], [0.0; WIDE_LANES]);
        for part in 0..R::PARTS {
            let (factor, integer) = wide_exp2_parts(register, register.wide_load(self.0, part));
            register.wide_store(factor, &mut factors, part);
            register.wide_store(integer, &mut integers, part);
        }
        (factors, integers)
    }
}

/// Compared with the power of the fraction by the standard library. Its own error, up to half a unit in the last place,
/// hardly meets the largest one.
#[test]
fn parts_keep_the_error_bound_and_their_bits() {
    let mut worst = 0.0_f64;
    for i in 0..50_000_u32 {
        let exponents: Wide = std::array::from_fn(|l| -1.234_567e-3 * f64::from(i) * 3.0_f64.powi(l as i32) + l as f64);
        let mut bits: Option<[u64; WIDE_LANES]> = None;
        each_set(|dispatch| {
            let (factors, integers) = dispatch.run_on_registers(Parts(&exponents));
            for l in 0..WIDE_LANES {
                let fraction = exponents[l] - integers[l];
                assert!(integers[l].fract() == 0.0 && fraction.abs() <= 0.5);
                worst = worst.max((factors[l] / fraction.exp2() - 1.0).abs());
            }
            let found = factors.map(f64::to_bits);
            assert_eq!(*bits.get_or_insert(found), found, "{}", dispatch.instruction_set());
        });
    }
    assert!((5e-17..EXP2_PARTS_ERROR + 3e-17).contains(&worst), "{worst:e}");
    each_set(|dispatch| {
        let exponents = [
            0.0,
            -0.0,
            1.0,
            -37.0,
            1023.0,
            -1022.0,
            2.0_f64.powi(51) - 1.0,
            1.0 - 2.0_f64.powi(51),
        ];
        assert_eq!(
            dispatch.run_on_registers(Parts(&exponents)),
            ([1.0; WIDE_LANES], exponents)
        );
    });
}

#[test]
fn exponents_out_of_range_are_clamped() {
    each_set(|dispatch| {
        let mut narrow = [-f32::INFINITY; LANES];
        narrow[..5].copy_from_slice(&[0.0, -COST_LIMIT, -1e30, f32::NAN, -125.0]);
        let mut wide = [-f64::INFINITY; WIDE_LANES];
        wide[..5].copy_from_slice(&[0.0, -COST_LIMIT_64, -1e300, f64::NAN, -901.0]);
        dispatch.run_on_registers(Exp2(&mut narrow, &mut wide));
        for (l, power) in narrow.iter().enumerate() {
            let exact = if l == 0 { 1.0 } else { (-COST_LIMIT).exp2() };
            assert!((power / exact - 1.0).abs() < 1e-6, "{l}: {power:e}");
        }
        for (l, power) in wide.iter().enumerate() {
            let exact = if l == 0 { 1.0 } else { (-COST_LIMIT_64).exp2() };
            assert!((power / exact - 1.0).abs() < 1e-12, "{l}: {power:e}");
        }
    });
}

struct Powers<'a>(&'a mut [Narrow]);

impl Kernel for Powers<'_> {
    #[inline(always)]
    fn run<S: Simd>(self, simd: S) {
        for lanes in self.0 {
            let power = simd.exp2(simd.load(lanes));
            simd.store(power, lanes);
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
        assert!((1e-8..3e-7).contains(&worst), "{set}: {worst:e}");
    });
}

#[test]
fn groups_are_one_at_zero_and_vanish() {
    each_set(|dispatch| {
        let set = dispatch.instruction_set();
        let below = f32::from_bits((-96.0_f32).to_bits() + 1);
        let last = powers(dispatch, &[-96.0])[0];
        assert!((f64::from(last) * 96_f64.exp2() - 1.0).abs() < 3e-7, "{set}: {last:e}");
        let ends = [0.0, below, -126.5, -127.0, -1e4, f32::NEG_INFINITY, f32::NAN];
        let found = powers(dispatch, &ends).into_iter().map(f32::to_bits);
        let found: Vec<u32> = found.collect();
        assert_eq!(found, [1.0_f32.to_bits(), 0, 0, 0, 0, 0, 0], "{set}");
    });
}
