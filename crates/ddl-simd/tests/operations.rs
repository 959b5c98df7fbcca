//! Every operation agrees with its documentation on every instruction set: compared with scalar arithmetic.
#![allow(clippy::unwrap_used, reason = "a test may panic")]
#![expect(clippy::inline_always, reason = "compiled per instruction set")]

use ddl_simd::{DEPTH, Dispatch, InstructionSet, Kernel, LANES, Simd, TiledKernel};
use proptest::prelude::*;

type Narrow = [f32; LANES];

const HALF: usize = LANES / 2;

fn each_set() -> impl Iterator<Item = Dispatch> {
    InstructionSet::available().into_iter().map(|set| Dispatch::new(set).unwrap())
}

struct OnGroups<'a> {
    numbers: &'a [Narrow; 3],
    word: u32,
    floats: &'a mut Vec<Narrow>,
}

impl Kernel for OnGroups<'_> {
    #[inline(always)]
    fn run<S: Simd>(self, simd: S) {
        let [a, b, c] = [0, 1, 2].map(|i: usize| simd.load(&self.numbers[i]));
        let bits = (simd.count_from(self.word) ^ 0x9e37_79b9) << 3;
        let mixed = (bits ^ (bits >> 7)) * 0x85eb_ca6b;
        let [d, e, f, g] = simd.transpose([a, b, c, a - b]);
        let [s, t, u, v] = simd.spread_each(a);
        let [mut low, mut high] = [[0.0; HALF]; 2];
        simd.store_halves(b, &mut high, &mut low);
        simd.prefetch(&low[0]);
        let results = [
            simd.splat(2.5),
            s,
            t,
            u,
            v,
            simd.sum_of_quarters(a),
            simd.keep(a, mixed, 0x8000_0000),
            simd.keep(b, mixed, 0x2000_0000),
            d,
            e,
            f,
            g,
            simd.load_halves(&low, &high),
        ];
        for result in results {
            let mut lanes = [0.0; LANES];
            simd.store(result, &mut lanes);
            self.floats.push(lanes);
        }
    }
}

fn mixed(first: u32, lane: usize) -> u32 {
    let word = (first ^ lane as u32 ^ 0x9e37_79b9) << 3;
    (word ^ (word >> 7)).wrapping_mul(0x85eb_ca6b)
}

/// The expected results of one lane, as documented.
fn expected([a, b, c]: &[Narrow; 3], word: u32, l: usize) -> Vec<f32> {
    let four = l / DEPTH * DEPTH;
    let quarter = |from: usize| a[l % DEPTH + from * DEPTH];
    let keep = |number: f32, least| if mixed(word, l) >= least { number } else { 0.0 };
    let groups = [*a, *b, *c, std::array::from_fn(|l| a[l] - b[l])];
    let mut expected = vec![2.5];
    expected.extend((0..DEPTH).map(|from| a[four + from]));
    expected.push((quarter(0) + quarter(2)) + (quarter(1) + quarter(3)));
    expected.extend([keep(a[l], 0x8000_0000), keep(b[l], 0x2000_0000)]);
    expected.extend((0..DEPTH).map(|j| groups[l % DEPTH][four + j]));
    expected.push(b[(l + HALF) % LANES]);
    expected
}

fn same(a: f32, b: f32) -> bool {
    a.to_bits() == b.to_bits() || a.is_nan() && b.is_nan()
}

fn number() -> impl Strategy<Value = f32> {
    prop_oneof![
        -4.0..4.0_f32,
        any::<u32>().prop_map(f32::from_bits),
        prop_oneof![Just(0.0_f32), Just(-0.0), Just(f32::NAN)],
    ]
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn groups(numbers in prop::array::uniform3(prop::array::uniform16(number())), word in any::<u32>()) {
        for dispatch in each_set() {
            let mut floats = Vec::new();
            dispatch.run(OnGroups { numbers: &numbers, word, floats: &mut floats });
            for l in 0..LANES {
                let expected = expected(&numbers, word, l);
                prop_assert_eq!(floats.len(), expected.len());
                for (i, (lanes, expected)) in floats.iter().zip(expected).enumerate() {
                    prop_assert!(
                        same(lanes[l], expected),
                        "{:?}, {}, lane {}: {} {}", dispatch, i, l, lanes[l], expected
                    );
                }
            }
        }
    }
}

/// Records the tile size that it is compiled for.
struct OnTiles<'a>(&'a mut Vec<(usize, usize)>);

impl TiledKernel for OnTiles<'_> {
    #[inline(always)]
    fn run<S: Simd, const R: usize, const V: usize>(self, _simd: S) {
        self.0.push((R, V));
    }
}

/// An accumulator of sixteen numbers fills one of the 32 registers of AVX-512, two of the 16 of AVX2, and four of the
/// at least 16 of other machines. The tile must leave registers for the operands.
#[test]
fn tiled_kernels_run_once_with_a_tile_that_the_registers_hold() {
    for dispatch in each_set() {
        let mut tiles = Vec::new();
        dispatch.run(OnTiles(&mut tiles));
        let [(rows, vectors)] = tiles[..] else { panic!("{dispatch:?}: {tiles:?}") };
        assert!(8 % rows == 0 && (1..=2).contains(&vectors), "{dispatch:?}");
        let (each, available) = match dispatch.instruction_set() {
            InstructionSet::Avx512 => (1, 32),
            InstructionSet::Avx2 => (2, 16),
            _ => (4, 16),
        };
        let registers = each * rows * vectors;
        assert!((1..available).contains(&registers), "{dispatch:?}");
    }
}

/// Compared with the feature detection of the standard library.
#[test]
fn the_instruction_sets_of_the_processor_are_available_slowest_first() {
    let available = InstructionSet::available();
    assert_eq!(available.last(), Some(&Dispatch::detect().instruction_set()));
    assert_eq!(available.first(), Some(&InstructionSet::Portable));
    for &set in &available {
        assert_eq!(Dispatch::new(set).unwrap().instruction_set(), set);
    }
    #[cfg(target_arch = "x86_64")]
    {
        let avx2 = is_x86_feature_detected!("avx2") && is_x86_feature_detected!("fma");
        let avx512 = is_x86_feature_detected!("avx512f") && is_x86_feature_detected!("avx512vbmi2");
        assert_eq!(available.contains(&InstructionSet::Avx2), avx2);
        assert_eq!(available.contains(&InstructionSet::Avx512), avx2 && avx512);
    }
}
