//! The estimator in the heading frame, against its definition (docs/method.md, "Analogues in the pedestrian's own
//! frame") evaluated in numpy outside this project. `reference/analogues.json` has a library of eight tracks and the
//! results for two pedestrians: one that walks and turns, and one with steps below 0.2 m.

use crate::tracks::{Positions, distance, estimator, walk};
use ddl_goal::{GoalEstimator, GoalEstimatorParams};
use serde::Deserialize;

/// x = a t + b t², y = c t + d t² (m), t counting steps.
type Coefficients = [f64; 4];

#[derive(Deserialize)]
struct Definition {
    library: Vec<Coefficients>,
    pedestrians: Vec<DefinedPedestrian>,
}

#[derive(Deserialize)]
struct DefinedPedestrian {
    track: Coefficients,
    analogues: Vec<Analogue>,
}

#[derive(Deserialize)]
struct Analogue {
    index: usize,
    mirrored: bool,
    distance: f64,
    weight: f64,
    end: [f64; 2],
}

fn track([a, b, c, d]: Coefficients) -> Positions {
    let place = |t: f64| [a * t + b * t * t, c * t + d * t * t];
    (0..20).map(|t| place(f64::from(t))).collect()
}

fn reference() -> Definition {
    serde_json::from_str(include_str!("reference/analogues.json")).unwrap()
}

fn of_six(library: &[Coefficients], clusters: usize) -> GoalEstimator {
    let params = GoalEstimatorParams { experts: 6, clusters, ..Default::default() };
    estimator(params, library.iter().map(|&walk| track(walk)).collect())
}

#[test]
fn distances_weights_and_endpoints_agree_with_the_definition() {
    let reference = reference();
    let estimator = of_six(&reference.library, 6);
    for pedestrian in reference.pedestrians {
        let observed = &track(pedestrian.track)[..8];
        let set = estimator.estimate(observed).unwrap();
        assert_eq!(set.experts().len(), pedestrian.analogues.len());
        for (k, analogue) in pedestrian.analogues.iter().enumerate() {
            let expert = set.experts()[k];
            let chosen = (expert.index, expert.mirrored);
            assert_eq!(chosen, (analogue.index, analogue.mirrored));
            // The estimator compares in `f32`.
            assert!((expert.distance - analogue.distance).abs() < 1e-7);
            assert!((set.weights()[k] - analogue.weight).abs() < 1e-5);
            assert!(distance(set.goals()[k], analogue.end) < 1e-8, "{set:?}");
        }
    }
}

#[test]
fn a_goal_is_the_weighted_mean_of_its_analogues() {
    let reference = reference();
    let DefinedPedestrian { track: walk, analogues, .. } = &reference.pedestrians[0];
    let set = of_six(&reference.library, 2).estimate(&track(*walk)).unwrap();
    for (k, group) in [&analogues[..3], &analogues[3..]].into_iter().enumerate() {
        let total: f64 = group.iter().map(|analogue| analogue.weight).sum();
        let mean = [0, 1].map(|axis| group.iter().map(|one| one.weight * one.end[axis]).sum::<f64>() / total);
        assert!((set.weights()[k] - total).abs() < 1e-5, "{set:?}");
        assert!(distance(set.goals()[k], mean) < 1e-4, "{set:?}");
    }
}

#[test]
fn equal_analogues_weigh_the_same() {
    let turned = |side: f64| -> Positions {
        let mut track = walk(1.0, 0.0, 0.0);
        let onward = track[8..].iter_mut().zip(1..);
        onward.for_each(|(place, step)| place[1] += side * 0.1 * f64::from(step));
        track
    };
    let params = GoalEstimatorParams { clusters: 3, ..Default::default() };
    let library = [3.0, 0.0, -3.0].map(turned).to_vec();
    let set = estimator(params, library).estimate(&turned(0.0)).unwrap();
    // Each track is present with its mirror image.
    for weight in set.weights() {
        assert!((weight - 1.0 / 3.0).abs() < 1e-12, "{set:?}");
    }
}

#[test]
fn the_nearest_hundred_experts_are_kept() {
    let tracks = (0..300_u32).map(|i| walk(0.005 * f64::from(i), 0.1, 0.01));
    let params = GoalEstimatorParams { experts: 250, ..Default::default() };
    let set = estimator(params, tracks.collect()).estimate(&walk(1.0, 0.1, 0.01)).unwrap();
    assert_eq!(set.experts().len(), 100);
    let experts = set.experts();
    assert!(experts.is_sorted_by(|a, b| a.distance <= b.distance));
    assert_eq!(experts[0].index, 200);
}
