//! Whether the decisions look like chance.

use super::Dropout;
use super::reference::{bits, factor};

/// Bit l is whether unit 32 `block` + l is kept at p = 1/2.
fn kept(seed: u64, row: usize, block: usize) -> u32 {
    (0..32)
        .map(|l| u32::from(bits(seed, row, 32 * block + l) >= 32_768) << l)
        .sum()
}

#[test]
fn decisions_stay_what_they_are() {
    // Computed by a program in another language, written from the description.
    assert_eq!(kept(0, 0, 0), 0xbd60_8ba1);
    assert_eq!(kept(1, 0, 0), 0xdb4c_c23e);
    assert_eq!(kept(1, 1, 0), 0x6aa3_de8c);
    assert_eq!(kept(1, 0, 1), 0x5f1a_0c60);
    assert_eq!(kept((1 << 63) + 5, 999, 63), 0xf427_0060);
}

const ROWS: usize = 500;
const UNITS: usize = 2048;

/// -1 or 1, or so that the mean is 0 and the variance 1.
fn standardised(p: f64, seed: u64) -> Vec<f64> {
    let dropout = Dropout { p, seed };
    let p = (p * 65_536.0).round() / 65_536.0;
    let deviation = (p / (1.0 - p)).sqrt();
    let places = (0..ROWS).flat_map(|row| (0..UNITS).map(move |unit| (row, unit)));
    places
        .map(|(row, unit)| (factor(dropout, row, unit) - 1.0) / deviation)
        .collect()
}

/// The mean of products with a shift is normal with standard error 1 / sqrt(count): five of them are rare.
fn assert_uncorrelated(name: &str, a: &[f64], b: &[f64]) {
    let products = a.iter().zip(b).map(|(a, b)| a * b);
    let count = a.len().min(b.len()) as f64;
    let score = products.sum::<f64>() / count.sqrt();
    assert!(score.abs() < 5.0, "{name}: {score} standard errors");
}

#[test]
fn the_share_is_right_everywhere() {
    for p in [0.1, 0.5, 0.9] {
        let values = standardised(p, 1);
        let score = values.iter().sum::<f64>() / ((ROWS * UNITS) as f64).sqrt();
        assert!(score.abs() < 4.5, "{p}: {score}");
        let of_rows = values
            .chunks(UNITS)
            .map(|row| row.iter().sum::<f64>() / (UNITS as f64).sqrt());
        let of_units = (0..UNITS)
            .map(|unit| values[unit..].iter().step_by(UNITS).sum::<f64>() / (ROWS as f64).sqrt());
        let scores: Vec<f64> = of_rows.chain(of_units).collect();
        assert!(scores.iter().all(|score| score.abs() < 5.5), "{p}");
        // The scores vary as chance has it, not less: sum of squares over count is 1 to 5 standard errors.
        let mean = scores.iter().map(|score| score * score).sum::<f64>() / scores.len() as f64;
        assert!(
            (mean - 1.0).abs() < 5.0 * (2.0 / scores.len() as f64).sqrt(),
            "{p}: {mean}"
        );
    }
}

#[test]
fn neighbours_decide_apart() {
    for p in [0.1, 0.5] {
        let values = standardised(p, 2);
        // Units 16 apart share a word; rows follow one another every 2048.
        for shift in (1..=33)
            .chain([64, 1024])
            .chain((1..=9).map(|rows| rows * UNITS))
        {
            assert_uncorrelated(&format!("{p}, {shift}"), &values, &values[shift..]);
        }
        for shift in [
            UNITS - 16,
            UNITS - 1,
            UNITS + 1,
            UNITS + 16,
            16 * UNITS + 16,
        ] {
            assert_uncorrelated(&format!("{p}, {shift}"), &values, &values[shift..]);
        }
    }
}

#[test]
fn seeds_decide_apart() {
    let first = standardised(0.1, 7);
    for seed in [0, 6, 8, 9, 7 + (1 << 32), !7, 7 << 8] {
        let second = standardised(0.1, seed);
        assert_uncorrelated(&format!("{seed}"), &first, &second);
        for rows in 1..4 {
            assert_uncorrelated(&format!("{seed}, {rows}"), &first, &second[rows * UNITS..]);
        }
    }
}

/// Triples of units: a weak generator has right pairs and wrong triples.
#[test]
fn patterns_are_equally_frequent() {
    let mut counts = [0.0; 256];
    for row in 0..ROWS {
        for block in 0..UNITS / 32 {
            for byte in kept(3, row, block).to_le_bytes() {
                counts[usize::from(byte)] += 1.0;
            }
        }
    }
    let expected = counts.iter().sum::<f64>() / 256.0;
    let square = |count: &f64| (count - expected).powi(2) / expected;
    let chi_square = counts.iter().map(square).sum::<f64>();
    // 255 degrees of freedom: mean 255, deviation 22.6.
    assert!((142.0..368.0).contains(&chi_square), "{chi_square}");
}
