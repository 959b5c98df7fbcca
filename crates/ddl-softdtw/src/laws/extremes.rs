//! Extreme and invalid input: huge and tiny numbers, long sequences, and errors.

use crate::laws::{Sequence, dtw};
use crate::{SoftDtw, SoftDtwError};
use proptest::prelude::*;

/// Steps of every size, zero and subnormal numbers among them.
fn any_sequence() -> impl Strategy<Value = Sequence> {
    use prop::num::f64::{NORMAL, SUBNORMAL, ZERO};
    prop::collection::vec(prop::array::uniform2(NORMAL | ZERO | SUBNORMAL), 1..6)
}

fn any_gamma() -> impl Strategy<Value = f64> {
    let gammas = [0.0, f64::MIN_POSITIVE / 4.0, 1e-3, 1.0, 1e300, f64::MAX];
    prop::sample::select(gammas.to_vec())
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn no_finite_input_gives_nan(
        x in any_sequence(),
        y in prop::collection::vec(prop::array::uniform2(prop::num::f64::NORMAL | prop::num::f64::ZERO), 1..6),
        gamma in any_gamma(),
        tiny in any::<bool>(),
    ) {
        let dtw = dtw(gamma);
        // Components of every size, or all of them small enough for their squares.
        let shrunk = |s: &Sequence| s.iter().map(|p| p.map(|v| if tiny { v % 1e150 } else { v })).collect::<Vec<_>>();
        let (x, y) = (shrunk(&x), shrunk(&y));
        for result in [dtw.value(&x, &y), dtw.normalised(&x, &y), dtw.value_and_gradient(&x, &y).map(|r| r.0)] {
            match result {
                Ok(value) => prop_assert!(value.is_finite()),
                Err(error) => prop_assert!(!tiny && error == SoftDtwError::Overflow || gamma > 1e299, "{}", error),
            }
        }
    }
}

#[test]
fn the_number_of_paths_may_leave_the_range_of_f64() {
    // All costs 0: minus the logarithm of a Delannoy number, here about 2^3400.
    let smooth = dtw(1.0);
    let zeros = |steps| vec![[0.0_f64]; steps];
    let value = smooth.value(&zeros(1500), &zeros(1200)).unwrap();
    let oracle = smooth.grid(&zeros(1500), &zeros(1200)).log_domain_value();
    assert!(value < -2300.0);
    assert!((value - oracle).abs() < 1e-9, "{value} {oracle}");
    // Half a power of two lost in each of 2 · 1400 cells does not underflow either.
    let half = vec![[std::f64::consts::LN_2.sqrt() * 0.7]; 1400];
    let value = smooth.value(&half, &zeros(1400)).unwrap();
    let oracle = smooth.grid(&half, &zeros(1400)).log_domain_value();
    assert!((value - oracle).abs() < 1e-9, "{value} {oracle}");
    let (_, gradient) = smooth.value_and_gradient(&half, &zeros(1400)).unwrap();
    let (_, oracle) = smooth.grid(&half, &zeros(1400)).log_domain_gradient();
    for (a, b) in gradient.iter().zip(&oracle) {
        assert!((a[0] - b[0]).abs() < 1e-8, "{} {}", a[0], b[0]);
    }
}

#[test]
fn a_path_of_thousands_of_cells_along_one_row_and_one_column_is_not_lost() {
    // Each cell of the cheap path takes half a power of two, 2299 in the first row and as many in the last column.
    let (gamma, steps) = (1.0, 2300);
    let off = (0.49 * std::f64::consts::LN_2).sqrt();
    let x: Vec<_> = (0..steps).map(|i| [if i == 0 { 0.0 } else { 10.0 }]).collect();
    let y: Vec<_> = (0..steps).map(|j| [if j + 1 == steps { 10.0 + off } else { off }]).collect();
    let expected = 2.0 * f64::from(steps - 1) * off * off;
    let value = dtw(gamma).value(&x, &y).unwrap();
    // Every other path costs at least 90 more.
    assert!((value - expected).abs() < 1e-9, "{value} {expected}");
}

#[test]
fn bad_input_is_refused_by_name() {
    for gamma in [-1.0, f64::NAN, f64::INFINITY] {
        assert!(matches!(SoftDtw::new(gamma).unwrap_err(), SoftDtwError::InvalidGamma { .. }));
    }
    let dtw = dtw(1.0);
    let empty: &[[f64; 1]] = &[];
    let message = |result: Result<f64, SoftDtwError>| result.unwrap_err().to_string();
    let expected = "sequence y is empty: soft-DTW needs at least one step";
    assert_eq!(message(dtw.value(&[[0.0]], empty)), expected);
    assert!(dtw.value(empty, &[[0.0]]).is_err());
    let expected = "sequence x, step 1, component 0 is NaN: must be finite";
    assert_eq!(message(dtw.value(&[[0.0], [f64::NAN]], &[[0.0]])), expected);
    assert!(dtw.value_and_gradient(&[[0.0]], &[[f64::INFINITY]]).is_err());
    assert_eq!(dtw.value(&[[1e200]], &[[-1e200]]), Err(SoftDtwError::Overflow));
    assert_eq!(dtw.value(&[[3e160]], &[[0.0]]), Err(SoftDtwError::Overflow));
}
