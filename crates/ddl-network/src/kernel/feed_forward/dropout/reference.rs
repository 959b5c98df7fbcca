//! The decisions one by one, and tests of their randomness.

use crate::kernel::feed_forward::dropout::{Dropout, mixed};
use crate::kernel::tests::chance::Decided;

fn bits(seed: u64, row: usize, unit: usize) -> u32 {
    let key = mixed(mixed(seed).wrapping_add(row as u64));
    let (block, lane) = (unit / 32, unit % 32);
    let word = key as u32 ^ (block * 16 + lane % 16) as u32;
    let word = (word ^ (word >> 16)).wrapping_mul(0x7feb_352d);
    let word = (word ^ (word >> 15) ^ (key >> 32) as u32).wrapping_mul(0x846c_a68b);
    let word = word ^ (word >> 16);
    if lane < 16 { word & 0xffff } else { word >> 16 }
}

/// The factor of a unit: 0 if it is dropped, otherwise 1 / (1 - p).
pub(crate) fn factor(dropout: Dropout, row: usize, unit: usize) -> f64 {
    let dropped = (dropout.p * 65_536.0).round().min(65_535.0);
    if f64::from(bits(dropout.seed, row, unit)) < dropped { 0.0 } else { 65_536.0 / (65_536.0 - dropped) }
}

#[test]
fn decisions_stay_what_they_are() {
    // Bit l: whether unit 32 `block` + l is kept at p = 1/2.
    let kept_units = |seed: u64, row: usize, block: usize| -> u32 {
        let bit = |l: usize| u32::from(bits(seed, row, 32 * block + l) >= 32_768);
        (0..32).map(|l| bit(l) << l).sum()
    };
    // Computed by an independent program in another language.
    assert_eq!(kept_units(0, 0, 0), 0xbd60_8ba1);
    assert_eq!(kept_units(1, 0, 0), 0xdb4c_c23e);
    assert_eq!(kept_units(1, 1, 0), 0x6aa3_de8c);
    assert_eq!(kept_units(1, 0, 1), 0x5f1a_0c60);
    assert_eq!(kept_units((1 << 63) + 5, 999, 63), 0xf427_0060);
}

#[test]
fn decisions_are_like_chance_and_seeds_decide_apart() {
    let decided = |p: f64, seed| {
        let rounded = (p * 65_536.0).round() / 65_536.0;
        Decided::new(rounded, [500, 2048], |row, unit| factor(Dropout { p, seed }, row, unit) == 0.0)
    };
    for p in [0.1, 0.5, 0.9] {
        decided(p, 1).assert_like_chance();
    }
    let first = decided(0.1, 7);
    for seed in [0, 6, 8, 9, 7 + (1 << 32), !7, 7 << 8] {
        first.assert_apart_from(&format!("seed {seed}"), &decided(0.1, seed));
    }
}
