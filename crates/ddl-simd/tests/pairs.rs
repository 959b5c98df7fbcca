//! Arithmetic on pairs of bf16 numbers: every implementation gives the bits of the definition.
#![allow(clippy::unwrap_used, reason = "a test may panic")]
#![allow(clippy::float_cmp, reason = "rounding is exact")]
#![expect(clippy::inline_always, reason = "compiled per instruction set")]

use proptest::prelude::*;

use ddl_simd::{Dispatch, InstructionSet, LANES, PairDispatch, PairKernel, Pairs, Simd};

fn ways() -> Vec<PairDispatch> {
    let emulated = InstructionSet::available().into_iter();
    let mut ways: Vec<_> = emulated
        .map(|set| PairDispatch::emulated(Dispatch::new(set).unwrap()))
        .collect();
    let emulated = PairDispatch::emulated(Dispatch::detect());
    assert!(!emulated.is_native());
    let fastest = PairDispatch::detect();
    if fastest.is_native() {
        ways.push(fastest);
    }
    ways
}

struct All<'a>(&'a [[f32; LANES]; 2], &'a [[u32; LANES]; 2], &'a mut Results);

#[derive(Default)]
struct Results {
    neighbours: [u32; LANES],
    across: [u32; LANES],
    dot: [f32; LANES],
    splat: [u32; LANES],
}

impl PairKernel for All<'_> {
    #[inline(always)]
    fn run<P: Pairs>(self, pairs: P) {
        let (Self(numbers, words, results), simd) = (self, pairs.simd());
        let [a, b] = [simd.load(&numbers[0]), simd.load(&numbers[1])];
        pairs.store(pairs.neighbours(a, b), &mut results.neighbours);
        pairs.store(pairs.across(a, b), &mut results.across);
        let [v, w] = [pairs.load(&words[0]), pairs.load(&words[1])];
        simd.store(pairs.dot(v, w, a), &mut results.dot);
        pairs.store(pairs.splat(words[0][3]), &mut results.splat);
    }
}

fn all(way: PairDispatch, numbers: &[[f32; LANES]; 2], words: &[[u32; LANES]; 2]) -> Results {
    let mut results = Results::default();
    way.run(All(numbers, words, &mut results));
    results
}

/// The bf16 number nearest to `value`, found from the two that enclose it.
fn rounded(value: f32) -> u16 {
    if value.is_nan() {
        return (value.to_bits() >> 16) as u16 | 0x40;
    }
    if value.is_subnormal() {
        return if value.is_sign_negative() { 0x8000 } else { 0 };
    }
    let below = (value.to_bits() >> 16) as u16;
    let wide = |half: u16| f64::from(f32::from_bits(u32::from(half) << 16));
    // For rounding, the next power of two follows the largest finite number.
    let above = below + u16::from(value.is_finite());
    let end = if wide(above).is_infinite() && value.is_finite() {
        2_f64.powi(128).copysign(f64::from(value))
    } else {
        wide(above)
    };
    let [to_below, to_above] = [wide(below), end].map(|w| (f64::from(value) - w).abs());
    if to_above < to_below || to_above == to_below && below % 2 == 1 {
        above
    } else {
        below
    }
}

fn flushed(value: f32) -> f32 {
    if value.is_subnormal() {
        0.0_f32.copysign(value)
    } else {
        value
    }
}

fn dot(a: u32, b: u32, sum: f32) -> f32 {
    let half = |word: u32, which: u32| flushed(f32::from_bits(word >> (16 * which) << 16));
    let sum = flushed(half(a, 1).mul_add(half(b, 1), flushed(sum)));
    flushed(half(a, 0).mul_add(half(b, 0), sum))
}

fn same(a: f32, b: f32) -> bool {
    a.to_bits() == b.to_bits() || a.is_nan() && b.is_nan()
}

fn check(numbers: &[[f32; LANES]; 2], words: &[[u32; LANES]; 2]) {
    for way in ways() {
        let found = all(way, numbers, words);
        let flat = numbers.as_flattened();
        for l in 0..LANES {
            let pair = |a: f32, b: f32| u32::from(rounded(a)) | u32::from(rounded(b)) << 16;
            let (a, b) = (flat[2 * l], flat[2 * l + 1]);
            assert_eq!(found.neighbours[l], pair(a, b), "{way:?}: {a} beside {b}");
            let (a, b) = (numbers[0][l], numbers[1][l]);
            assert_eq!(found.across[l], pair(a, b), "{way:?}: {a} over {b}");
            let (v, w) = (words[0][l], words[1][l]);
            let exact = dot(v, w, a);
            assert!(
                same(found.dot[l], exact),
                "{way:?}: {v:x} {w:x} on {a:e} are {:e}, not {exact:e}",
                found.dot[l]
            );
            assert_eq!(found.splat[l], words[0][3]);
        }
    }
}

/// Any bits, and numbers of similar size, whose sums cancel and round.
fn number() -> impl Strategy<Value = f32> {
    prop_oneof![
        any::<u32>().prop_map(f32::from_bits),
        -4.0..4.0_f32,
        (any::<u16>(), 0x7ffe..0x8002_u32).prop_map(|(half, rest)| f32::from_bits(u32::from(half) << 16 | rest)),
        (0..0x0200_0000_u32, any::<bool>()).prop_map(|(bits, sign)| f32::from_bits(bits | u32::from(sign) << 31)),
    ]
}

fn word() -> impl Strategy<Value = u32> {
    let half = || prop_oneof![any::<u16>(), (0x3e80..0x4100_u16), (0xbe80..0xc100_u16)];
    (half(), half()).prop_map(|(a, b)| u32::from(a) | u32::from(b) << 16)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    #[test]
    fn every_implementation_agrees_with_the_definition(
        numbers in prop::array::uniform2(prop::array::uniform16(number())),
        words in prop::array::uniform2(prop::array::uniform16(word())),
    ) {
        check(&numbers, &words);
    }
}

/// By hand: 1 + 2^-8 lies between two bf16 numbers, and 1 is the even one; 1 + 3 2^-8 goes up.
#[test]
fn known_numbers() {
    let numbers = [1.0 + 1.0 / 256.0, 1.0 + 3.0 / 256.0, -1.0 / 3.0, 1e-40];
    let halves = [0x3f80, 0x3f82, 0xbeab, 0];
    for way in ways() {
        for (number, half) in numbers.into_iter().zip(halves) {
            let found = all(way, &[[number; LANES]; 2], &[[0; LANES]; 2]);
            assert_eq!(found.neighbours, [half | half << 16; LANES], "{way:?}");
            assert_eq!(found.across, found.neighbours, "{way:?}");
        }
    }
    // (1 + 2^24) - 2^24: the first sum is half way between two numbers and rounds to 2^24.
    let words = [[0x4580_4580; LANES], [0x4580_c580; LANES]];
    for way in ways() {
        let sums = all(way, &[[1.0; LANES]; 2], &words).dot;
        assert!(sums.iter().all(|sum| *sum == 0.0), "{way:?}: {sums:?}");
    }
}
