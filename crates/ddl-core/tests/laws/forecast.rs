//! Valid forecasts and errors.

use ddl_core::{Forecast, ForecastShapeError, HORIZON, Position};

fn constant(positions: &[Position]) -> Vec<Position> {
    positions.iter().flat_map(|&p| [p; HORIZON]).collect()
}

#[test]
fn wrong_shapes_and_weights_are_named() {
    let one = constant(&[[0.0, 0.0]]);
    let twice = constant(&[[0.0, 0.0], [0.0, 0.0]]);
    let mut nan = twice.clone();
    nan[13] = [f64::NAN, 0.0];
    let check = |n, k, positions: &[Position], weights: &[f64], expected: &str| {
        let refused = Forecast::new(n, k, positions.to_vec(), weights.to_vec(), None);
        let words = refused.unwrap_err().to_string();
        assert!(words.starts_with(expected), "{words}");
    };
    check(0, 1, &[], &[], "a forecast needs at least one pedestrian");
    check(1, 1, &one[1..], &[1.0], "`positions` must hold 12 entries");
    check(1, 1, &one, &[], "`weights` must hold 1 entries");
    check(1, 1, &one, &[0.9], "the weights of pedestrian 0 sum to 0.9");
    let negative = "the weight of pedestrian 0, hypothesis 1 is -0.5, below 0";
    check(1, 2, &twice, &[1.5, -0.5], negative);
    let not_finite = "`positions` of pedestrian 1, hypothesis 0 is not finite";
    check(2, 1, &nan, &[1.0, 1.0], not_finite);
    let goals = Some(vec![[f64::INFINITY, 0.0]]);
    let refused = Forecast::new(1, 1, one, vec![1.0], goals).unwrap_err();
    assert!(matches!(refused, ForecastShapeError::NotFinite { field: "goals", .. }));
}

#[test]
fn layout_is_pedestrian_hypothesis_frame_and_the_heavier_of_two_stays() {
    let ends = [[0.0, 1.0], [0.0, 2.0], [0.0, 3.0], [0.0, 4.0]];
    let (weights, goals) = (vec![0.25, 0.75, 0.5, 0.5], Some(ends.to_vec()));
    let forecast = Forecast::new(2, 2, constant(&ends), weights, goals).unwrap();
    assert_eq!(forecast.hypothesis(1, 0), &[[0.0, 3.0]; HORIZON]);
    assert_eq!(forecast.goal(0, 1), Some([0.0, 2.0]));
    assert_eq!((forecast.most_likely(0), forecast.most_likely(1)), (1, 0));
    assert_eq!(forecast.single().certified(1, 0), None);
    for length in [0, 3, 5] {
        let refused = forecast.clone().with_certified(vec![true; length]);
        let complaint = refused.unwrap_err().to_string();
        let expected = "`certified` must hold 4 entries (pedestrian, hypothesis), found";
        assert_eq!(complaint, format!("{expected} {length}"));
    }
    let verdicts = vec![true, false, true, false];
    let forecast = forecast.with_certified(verdicts).unwrap();
    let first = forecast.of_pedestrians(&[0]);
    assert_eq!(
        (first.pedestrians(), first.hypotheses(), first.weight(0, 1).to_bits()),
        (1, 2, 0.75_f64.to_bits())
    );
    assert_eq!(
        (first.hypothesis(0, 1), first.goal(0, 1)),
        (forecast.hypothesis(0, 1), Some([0.0, 2.0]))
    );
    assert_eq!(
        (first.certified(0, 0), first.certified(0, 1)),
        (Some(true), Some(false))
    );
    let single = forecast.single();
    assert_eq!((single.pedestrians(), single.hypotheses()), (2, 1));
    assert_eq!(single.hypothesis(0, 0), &[[0.0, 2.0]; HORIZON]);
    assert_eq!(single.goal(1, 0), Some([0.0, 3.0]));
    let certificates = (single.certified(0, 0), single.certified(1, 0));
    assert_eq!(certificates, (Some(false), Some(true)));
    assert_eq!(single.single(), single);
    let without = Forecast::with_equal_weights(1, 2, constant(&ends[..2])).unwrap();
    assert!(!without.single().has_goals());
}
