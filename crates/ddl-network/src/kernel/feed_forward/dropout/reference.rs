//! The decisions one by one.

use super::{Dropout, mixed};

/// 16 random bits.
pub(super) fn bits(seed: u64, row: usize, unit: usize) -> u32 {
    let key = mixed(mixed(seed).wrapping_add(row as u64));
    let (block, lane) = (unit / 32, unit % 32);
    let word = key as u32 ^ (block * 16 + lane % 16) as u32;
    let word = (word ^ (word >> 16)).wrapping_mul(0x7feb_352d);
    let word = (word ^ (word >> 15) ^ (key >> 32) as u32).wrapping_mul(0x846c_a68b);
    let word = word ^ (word >> 16);
    if lane < 16 { word & 0xffff } else { word >> 16 }
}

/// 0 for a unit that is dropped, else what it is scaled by.
pub(crate) fn factor(dropout: Dropout, row: usize, unit: usize) -> f64 {
    let dropped = (dropout.p * 65_536.0).round().min(65_535.0);
    if f64::from(bits(dropout.seed, row, unit)) < dropped {
        0.0
    } else {
        65_536.0 / (65_536.0 - dropped)
    }
}
