//! The operations of every instruction set that this machine has.
#![expect(clippy::inline_always, reason = "kernels are compiled for the set")]

use super::{
    COST_LIMIT, COST_LIMIT_64, Dispatch, EXP2_ERROR, EXP2_ERROR_64, InstructionSet, Kernel, LANES,
    Lanes, Simd, WIDE_LANES, WideLanes,
};

fn each_set(mut test: impl FnMut(Dispatch)) {
    for set in InstructionSet::available() {
        test(Dispatch::new(set).expect("available"));
    }
}

/// 2^x of sixteen and of eight numbers.
struct Exp2<'a>(&'a mut Lanes, &'a mut WideLanes);

impl Kernel for Exp2<'_> {
    type Output = ();

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) {
        for part in 0..S::PARTS {
            let power = simd.exp2(simd.load(self.0, part));
            simd.store(power, self.0, part);
            let [power] = simd.wide_exp2_each([simd.wide_load(self.1, part)]);
            simd.wide_store(power, self.1, part);
        }
    }
}

#[test]
fn exp2_keeps_its_error_bound_over_the_whole_range() {
    each_set(|dispatch| {
        let steps = 40_000;
        let mut worst = 0.0_f64;
        for i in 0..=steps {
            let exponents: Lanes = std::array::from_fn(|l| {
                let at = (f64::from(i) + l as f64 / LANES as f64) / f64::from(steps);
                -COST_LIMIT * at.min(1.0) as f32
            });
            let mut powers = exponents;
            dispatch.run(Exp2(&mut powers, &mut [0.0; WIDE_LANES]));
            for (power, exponent) in powers.iter().zip(exponents) {
                let exact = f64::from(exponent).exp2();
                worst = worst.max((f64::from(*power) / exact - 1.0).abs());
            }
        }
        let set = dispatch.instruction_set();
        assert!(worst < EXP2_ERROR, "{set}: {worst:e}");
        assert!(worst > 1e-8, "{set}: a test that cannot fail: {worst:e}");
    });
}

#[test]
fn wide_exp2_keeps_its_error_bound_and_its_bits() {
    let steps = 60_000;
    for i in 0..=steps {
        let exponents: WideLanes = std::array::from_fn(|l| {
            let at = (f64::from(i) + l as f64 / WIDE_LANES as f64) / f64::from(steps);
            // Dense near 0, where the nearest candidates are.
            -COST_LIMIT_64 * at.min(1.0).powi(3)
        });
        let mut bits: Option<[u64; WIDE_LANES]> = None;
        each_set(|dispatch| {
            let mut powers = exponents;
            dispatch.run(Exp2(&mut [0.0; LANES], &mut powers));
            for (power, exponent) in powers.iter().zip(exponents) {
                let error = (power / exponent.exp2() - 1.0).abs();
                assert!(error < EXP2_ERROR_64, "2^{exponent}: {error:e}");
            }
            let found = powers.map(f64::to_bits);
            assert_eq!(
                *bits.get_or_insert(found),
                found,
                "{}",
                dispatch.instruction_set()
            );
        });
    }
}

#[test]
fn exponents_out_of_range_are_clamped() {
    each_set(|dispatch| {
        let mut narrow = [-f32::INFINITY; LANES];
        narrow[..5].copy_from_slice(&[0.0, -COST_LIMIT, -1e30, f32::NAN, -125.0]);
        let mut wide = [-f64::INFINITY; WIDE_LANES];
        wide[..5].copy_from_slice(&[0.0, -COST_LIMIT_64, -1e300, f64::NAN, -901.0]);
        dispatch.run(Exp2(&mut narrow, &mut wide));
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

/// Every other operation, on three groups.
struct Operations<'a>([&'a Lanes; 3], [&'a WideLanes; 3]);

impl Kernel for Operations<'_> {
    type Output = ([Lanes; 10], u32, [WideLanes; 5]);

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) -> Self::Output {
        let mut narrow = [[0.0; LANES]; 10];
        let mut wide = [[0.0; WIDE_LANES]; 5];
        let mut mask = 0;
        for part in 0..S::PARTS {
            let a = simd.load(self.0[0], part);
            let b = simd.load(self.0[1], part);
            let c = simd.load(self.0[2], part);
            simd.store(simd.add(a, b), &mut narrow[0], part);
            simd.store(simd.sub(a, b), &mut narrow[1], part);
            simd.store(simd.mul(a, b), &mut narrow[2], part);
            simd.store(simd.mul_add(a, b, c), &mut narrow[3], part);
            simd.store(simd.neg_mul_add(a, b, c), &mut narrow[4], part);
            simd.store(simd.max(a, b), &mut narrow[5], part);
            simd.store(simd.splat(2.5), &mut narrow[6], part);
            simd.store(simd.cell(a, b, c, simd.splat(0.5)), &mut narrow[7], part);
            simd.store(simd.weigh(a, b), &mut narrow[8], part);
            simd.store(simd.div(a, simd.splat(4.0)), &mut narrow[9], part);
            mask |= simd.at_least(a, b) << (part * S::WIDTH);
            let a = simd.wide_load(self.1[0], part);
            let b = simd.wide_load(self.1[1], part);
            simd.wide_store(simd.wide_add(a, b), &mut wide[0], part);
            simd.wide_store(simd.wide_sub(a, b), &mut wide[1], part);
            simd.wide_store(simd.wide_mul(a, b), &mut wide[2], part);
            simd.wide_store(simd.wide_max(a, b), &mut wide[3], part);
            let root = simd.wide_add(simd.wide_sqrt(a), simd.wide_splat(2.5));
            simd.wide_store(root, &mut wide[4], part);
        }
        (narrow, mask, wide)
    }
}

#[test]
#[expect(clippy::float_cmp, reason = "small whole numbers are exact")]
fn operations_are_what_their_names_say() {
    let a: Lanes = std::array::from_fn(|l| l as f32);
    let b: Lanes = std::array::from_fn(|l| 11.0 - l as f32);
    let c: Lanes = std::array::from_fn(|l| (l * l) as f32);
    let wide = |lanes: &Lanes| -> WideLanes { std::array::from_fn(|l| f64::from(lanes[l])) };
    let (wide_a, wide_b, wide_c) = (wide(&a), wide(&b), wide(&c));
    each_set(|dispatch| {
        let set = dispatch.instruction_set();
        let (narrow, mask, wide) =
            dispatch.run(Operations([&a, &b, &c], [&wide_a, &wide_b, &wide_c]));
        for l in 0..LANES {
            let (a, b, c) = (a[l], b[l], c[l]);
            let found: [f32; 7] = std::array::from_fn(|i| narrow[i][l]);
            let expected = [a + b, a - b, a * b, a * b + c, c - a * b, a.max(b), 2.5];
            assert_eq!(found, expected, "{set}, lane {l}");
            assert_eq!(mask >> l & 1 == 1, a >= b, "{set}, lane {l}");
            let (cell, exact) = (narrow[7][l], a * (b + c + 0.5));
            let floor = a.max(1.0) * dispatch.floor();
            assert!(cell >= exact && cell <= exact + floor + exact.abs() * 1e-6);
            assert_eq!(narrow[9][l], a / 4.0);
            let (product, exact) = (narrow[8][l], a * b);
            assert!(product >= exact && product <= exact + floor + exact.abs() * 1e-6);
        }
        for l in 0..WIDE_LANES {
            let (a, b) = (wide_a[l], wide_b[l]);
            let found: [f64; 5] = std::array::from_fn(|i| wide[i][l]);
            let expected = [a + b, a - b, a * b, a.max(b), a.sqrt() + 2.5];
            assert_eq!(found, expected, "{set}, lane {l}");
        }
    });
}

#[test]
fn a_cell_is_never_denormal() {
    let tiny = [(-COST_LIMIT).exp2(); LANES];
    let zero = [0.0; LANES];
    let wide = [0.0; WIDE_LANES];
    each_set(|dispatch| {
        let (narrow, ..) = dispatch.run(Operations([&tiny, &zero, &zero], [&wide; 3]));
        let cells = narrow[7].iter().chain(&narrow[8]);
        assert!(cells.into_iter().all(|cell| cell.is_normal()));
    });
}
