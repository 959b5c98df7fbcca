//! Valid forecasts and errors.

use std::array::from_fn;

use ddl_core::{
    Forecast, ForecastShapeError, HORIZON, Pace, PedestrianId, Position, RegionTable, Spread, WeightedGoals, Window,
};

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
        let words = Forecast::new(n, k, positions.to_vec(), weights.to_vec(), None).unwrap_err().to_string();
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
        let complaint = forecast.clone().with_certified(vec![true; length]).unwrap_err().to_string();
        let expected = "`certified` must hold 4 entries (pedestrian, hypothesis), found";
        assert_eq!(complaint, format!("{expected} {length}"));
    }
    let verdicts = vec![true, false, true, false];
    let forecast = forecast.with_certified(verdicts).unwrap();
    let first = forecast.of_pedestrians(&[0]);
    assert_eq!((first.pedestrians(), first.hypotheses(), first.weight(0, 1).to_bits()), (1, 2, 0.75_f64.to_bits()));
    assert_eq!((first.hypothesis(0, 1), first.goal(0, 1)), (forecast.hypothesis(0, 1), Some([0.0, 2.0])));
    assert_eq!((first.certified(0, 0), first.certified(0, 1)), (Some(true), Some(false)));
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

/// Twelve scales for each of three pedestrians: 1 to 36.
fn spread(change: impl Fn(&mut Vec<f64>)) -> Spread {
    let mut scales = (1..=36).map(f64::from).collect();
    change(&mut scales);
    let regions = RegionTable::of(&[&[[0.5; HORIZON]; 9]; 3], &[0.5]).unwrap().into();
    let paces = Pace::ALL.to_vec();
    Spread { scales, paces, regions }
}

#[test]
fn numbers_out_of_range_are_refused() {
    let forecast = Forecast::with_equal_weights(3, 2, vec![[1.0, 2.0]; 72]).unwrap();
    assert_eq!(forecast.weight(2, 1).to_bits(), 0.5_f64.to_bits());
    for (value, i) in [(0.0, 14), (-1.0, 30), (f64::NAN, 0), (f64::INFINITY, 35)] {
        let refused = forecast.clone().with_spread(spread(|scales| scales[i] = value)).unwrap_err();
        let named = format!("the spread of pedestrian {} is {value}, out of range", i / 12);
        assert_eq!(refused.to_string(), named);
    }
    let familiar = |least: f64| forecast.clone().with_familiarity(vec![1.0, least, 1.0]).is_ok();
    assert_eq!([0.01, 0.0, 1.01, f64::NAN].map(familiar), [true, false, false, false]);
    let sums = |off: f64| Forecast::new(1, 2, vec![[0.0; 2]; 24], vec![0.5, 0.5 + off], None).is_ok();
    assert_eq!([-2e-6, -9e-7, 9e-7, 2e-6].map(sums), [false, true, true, false]);
    let refused = WeightedGoals::new(vec![[1.0, 2.0]; 6], vec![1.0]).unwrap_err().to_string();
    assert!(refused.starts_with("`weights` must hold 6 entries"), "{refused}");
}

#[test]
fn what_is_known_of_a_pedestrian_stays_with_it() {
    let places: Vec<Position> = (0..72).map(|n| [f64::from(n), 100.0 - f64::from(n * n)]).collect();
    let goals: Vec<Position> = (0..6).map(|n| [f64::from(n), -1.0]).collect();
    let forecast = Forecast::new(3, 2, places.clone(), [0.25, 0.75].repeat(3), Some(goals.clone())).unwrap();
    let forecast = forecast.with_certified(vec![true, true, true, true, true, false]).unwrap();
    let forecast = forecast.with_spread(spread(|_| {})).unwrap().with_familiarity(vec![0.5, 1.0, 0.25]).unwrap();
    let path = from_fn(|t| [-(t as f64), 7.0]);
    let moved = forecast.clone().with_path(1, &path);
    for k in 0..2 {
        assert_eq!((moved.hypothesis(1, k), moved.goal(1, k)), (&path[..], Some([-11.0, 7.0])));
        assert_eq!((moved.certified(1, k), moved.certified(0, k)), (Some(false), Some(true)));
    }
    let two = moved.of_pedestrians(&[2, 0]);
    for (index, i, scale) in [(0, 2, 30.0), (1, 0, 6.0)] {
        assert_eq!((two.scale(index, 5), two.scale(index, 11)), (Some(scale), Some(scale + 6.0)));
        assert_eq!((two.pace(index), two.familiarity(index)), (Some(Pace::ALL[i]), forecast.familiarity(i)));
        assert_eq!((two.goal(index, 1), two.certified(index, 1)), (Some(goals[2 * i + 1]), Some(i == 0)));
        assert_eq!(two.hypothesis(index, 1), &places[24 * i + 12..][..12]);
    }
    // The radius is s sqrt(2 (q + ln(w / max w))), of q = 0.5; one third has no disc.
    let (discs, [x, y]) = (two.region(0, 5, 0.5).unwrap(), places[65]);
    let inside = [[x, y - 29.9], [x, y - 30.1], [x + 21.5, y + 21.5], [x + 21.0, y]];
    assert_eq!(discs.len(), 1);
    assert_eq!(inside.map(|at| discs[0].contains(at)), [true, false, false, true]);
    assert_eq!(two.single().familiarity(0), Some(0.25));
    // Of a window with the bystander 2 between 1 and 3.
    let window = |ids: &[i64]| {
        let ids: Vec<_> = ids.iter().copied().map(PedestrianId).collect();
        let tracks = vec![vec![[0.0; 2]; 8]; ids.len()];
        Window::new("yard", 0, 1, ids, tracks).unwrap()
    };
    let scene = window(&[1, 3]).with_bystanders(Some(window(&[2])));
    assert_eq!(forecast.clone().without_bystanders(&scene), forecast.of_pedestrians(&[0, 2]));
}
