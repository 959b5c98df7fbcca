use super::*;
use crate::fixture::{futures, pedestrians, plan, scene};

/// Two futures of two pedestrians with two hypotheses: the first future mixes those of the first pedestrian in equal
/// parts and those of the second 1 to 4, the second future is one hypothesis of each.
#[test]
fn means_and_scales_by_hand() {
    let speeds = [vec![[0.0, 0.0], [0.75, -1.0]], vec![[1.0, 0.5], [1.0, 3.0]]];
    let crowd = futures(&[[1.0, 2.0], [-3.0, 0.5]], &speeds, &[0.5, 0.5], &[0.6, 1.2]);
    let mixture = JointMixture { weights: vec![0.7, 0.3], shares: vec![0.5, 0.5, 0.0, 1.0, 0.2, 0.8, 1.0, 0.0] };
    let end = |pair: usize| mixture.mean(pair, |i, h| crowd.forecast().hypothesis(i, h)[11]);
    let expected = [[1.0 + 1.8, 2.0 - 2.4], [1.0 + 3.6, 2.0 - 4.8], [-3.0 + 4.8, 0.5 + 12.0], [-3.0 + 4.8, 0.5 + 2.4]];
    for (pair, expected) in expected.into_iter().enumerate() {
        assert!((0..2).all(|axis| (end(pair)[axis] - expected[axis]).abs() < 1e-6), "{pair}: {:?}", end(pair));
    }
    let scales = mixture.scales(crowd.forecast()).unwrap();
    for (t, time) in (1..=12).map(|t| (t - 1, 0.4 * t as f64)) {
        // Half the way of 1.25 m/s from the mean; 0.2 and 0.8 of 2.5 m/s, so 0.16 of the square. A sixth of the mean
        // square over the futures is added to the square of the scale.
        let [first, second] = [0.7 * (0.625 * time).powi(2), 0.7 * 0.16 * (2.5 * time).powi(2)];
        let [narrow, wide] = [0.6, 1.2].map(|scale: f64| (scale * time / 4.8).powi(2));
        let expected = [(narrow + first / 6.0).sqrt(), (wide + second / 6.0).sqrt()];
        for (found, expected) in [scales[t], scales[12 + t]].into_iter().zip(expected) {
            assert!((found - expected).abs() < 1e-6, "{t}: {found} {expected}");
        }
    }
    assert_eq!(mixture.scales(&scene(&pedestrians("0 0 0 0  0.5 0 0  0.5 0 0")).1), None);
}

#[test]
fn futures_are_in_the_order_of_their_sizes() {
    let (labels, sizes) = by_size(vec![2, 0, 2, 1, 2, 1], 4);
    assert_eq!((labels, sizes), (vec![0, 2, 0, 1, 0, 1], vec![3, 2, 1, 0]));
}

/// By hand: of six who stand 0.5 m apart all let others come near, 6.5 of 8. Of two of whom one has gone 1.7 m from the
/// other, 0.3 m away, 2.5 of 4 do: (0.625 - 0.25) / 0.5 of the way from 0.4 to 0.22 m. Of two 3 m apart 0.5 of 4.
#[test]
fn people_pass_as_closely_as_they_did() {
    let row = |i: usize| format!("{} 0 0 0  0.5 0 0  0.5 0.3 0", 0.5 * i as f64);
    let gone = format!("2 0 {} 0  0.5 0 0  0.5 -0.4 0", 1.7 / 2.8);
    let still = "0 0 0 0  0.5 0 0  0.5 0.3 0".to_owned();
    let far = "3 0 0 0  0.5 0 0  0.5 -0.4 0".to_owned();
    for (people, count, expected) in
        [((0..6).map(row).collect(), 15, 0.22), (vec![still.clone(), gone], 1, 0.265), (vec![still, far], 1, 0.4)]
    {
        let (window, forecast) = scene(&pedestrians(&people.join("\n")));
        let scene = JointScene::of(&window, &forecast, None, None);
        let near: Vec<f32> = scene.pairs.iter().map(|pair| pair.energy.near).collect();
        assert!(near.len() == count && near.iter().all(|near| (near - expected).abs() < 1e-6), "{near:?} {expected}");
    }
}

/// A plan that crosses the way of the first hypothesis 2 s after the moment, 2 m ahead, and nothing else.
#[test]
fn a_plan_is_avoided_where_it_is_at_that_time() {
    let (window, forecast) = scene(&pedestrians(
        "3 -1 0 1  0.6 0 1  0.3 -1 -0.3  0.1 0.9 -0.4\n-30 8 0.4 0.1  0.2 0.4 0.1  0.5 0 0.4  0.3 1 0\n\
         70 -9 0 0  0.6 0 0  0.2 1 0  0.2 0 1",
    ));
    let crossing = |delay: f64, radius: f64| {
        let rows = [[0.0, 5.0, 1.0], [4.0, 1.0, 0.5], [9.0, 1.0, 0.0]];
        plan(&rows.map(|[time, x, share]| [time + delay, x, 1.0, share * radius]))
    };
    let shares = |plan: &Plan, ego, count: usize| -> [Vec<f64>; 2] {
        let scene = JointScene::of(&window, &forecast, Some(plan), ego);
        let chosen = sampling::samples(&scene.people, &scene.pairs, &[7, 8, 9, 10], count);
        [0, 1].map(|i| {
            let mut shares = vec![0.0; 3];
            for &hypothesis in &chosen[scene.order.iter().position(|other| *other == i).unwrap()] {
                shares[usize::from(hypothesis)] += 1.0 / count as f64;
            }
            shares
        })
    };
    // At a distance of 0 m the odds are divided by the exponential of the energy there.
    let collided = (-f64::from(Energy::learned().of_pair([3.0, 0.0], 0.0, 0.0, 0.0).conflict(0.0))).exp();
    let near = |found: &[f64], expected: [f64; 3]| found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 0.01);
    let after = |odds: f64| [0.6 * odds, 0.3, 0.1].map(|weight| weight / (0.6 * odds + 0.4));
    // 1.6 s earlier or later it passes at more than 1.1 m, within reach of a radius of 1 m.
    for (delay, radius, odds) in [(0.0, 0.0, collided), (-1.6, 0.0, 1.0), (1.6, 0.0, 1.0), (1.6, 1.14, collided)] {
        let [found, far] = shares(&crossing(delay, radius), None, 40_000);
        assert!(near(&found, after(odds)), "{delay} {radius}: {found:?} {odds}");
        assert!(near(&far, [0.2, 0.5, 0.3]), "{far:?}");
    }
    let [found, _] = shares(&crossing(0.0, 0.0), Some(1), 40_000);
    assert!(near(&found, after(collided)), "{found:?}");
    let [own, _] = shares(&crossing(0.0, 0.0), Some(0), 8);
    assert_eq!(own, [1.0, 0.0, 0.0]);
    // The likeliest future has somebody out of the way, because each future is free of collisions.
    let mixture = JointScene::of(&window, &forecast, Some(&crossing(0.0, 0.0)), None).mixture();
    assert!((0..3).all(|k| mixture.weights[k] == 0.0 || mixture.shares[3 * k] < 0.999), "{mixture:?}");
}
