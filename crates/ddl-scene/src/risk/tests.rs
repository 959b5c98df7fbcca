use super::crowd::CrowdAtRisk;
use super::quadrature::{DEVIATIONS, deviations_of_hypothesis};
use crate::fixture::{futures, plan, with_deviation};
use crate::{Futures, Plan, Risk, SceneError};
use ddl_core::{Forecast, HORIZON, OBSERVED, Pace, PedestrianId, Position, RegionTable, Spread, Window};
use proptest::{collection::vec, prelude::*};
use serde::Deserialize;

#[derive(Deserialize)]
struct RiskCase {
    starts: Vec<Position>,
    velocities: Vec<Vec<Position>>,
    weights: Vec<f64>,
    scales: Vec<f64>,
    deviation: f64,
    plan: Vec<[f64; 4]>,
    within: f64,
    ego: Option<usize>,
    /// The pedestrians, then the steps, then until the end of each step.
    unseen: Vec<f64>,
    seen: Vec<f64>,
    clearances: Vec<f64>,
    nearest: f64,
}

fn one(futures: &Futures, plan: &Plan, within: f64) -> Risk {
    futures.risks(std::slice::from_ref(plan), within, None).unwrap().remove(0)
}

fn close(a: &[f64], b: &[f64], tolerance: f64) -> bool {
    a.len() == b.len() && a.iter().zip(b).all(|(a, b)| (a - b).abs() <= tolerance)
}

/// `[N]` starts, `[N][3]` velocities and `[N]` scales; rows of a plan.
type RandomScene = (Vec<Position>, Vec<Vec<Position>>, Vec<f64>, Vec<[f64; 4]>);

/// Crowds at random places, plans of three rows.
fn scenes() -> impl Strategy<Value = RandomScene> {
    let place = || [-4.0..4.0f64, -4.0..4.0f64];
    let speeds = vec([-1.5..1.5f64, -1.5..1.5f64], 3);
    let rows = vec((place(), 0.0..0.6f64), 3);
    let rows = (rows, 0.1..2.3f64, 2.4..6.0f64).prop_map(|(rows, second, third)| {
        [0.0, second, third].into_iter().zip(rows).map(|(time, ([x, y], radius))| [time, x, y, radius]).collect()
    });
    (vec(place(), 4), vec(speeds, 4), vec(0.02..1.0f64, 4), rows)
}

/// The plan at a time, by its definition.
fn row_at(rows: &[[f64; 4]], time: f64) -> [f64; 4] {
    let Some(pair) = rows.windows(2).find(|pair| pair[0][0] <= time && time < pair[1][0]) else {
        return rows[if time < rows[0][0] { 0 } else { rows.len() - 1 }];
    };
    let [a, b] = [pair[0], pair[1]];
    let [t, x, y, _] =
        std::array::from_fn(|column| a[column] + (time - a[0]) / (b[0] - a[0]) * (b[column] - a[column]));
    [t, x, y, a[3]]
}

/// The least value of a convex function between two times, by ternary search.
fn least([mut from, mut to]: [f64; 2], value: impl Fn(f64) -> f64) -> f64 {
    let mut least = value(from).min(value(to));
    for _ in 0..30 {
        let [low, high] = [from + (to - from) / 3.0, to - (to - from) / 3.0];
        let [a, b] = [low, high].map(&value);
        least = least.min(a).min(b);
        if a < b { to = high } else { from = low }
    }
    least
}

const WEIGHTS: [f64; 3] = [0.5, 0.3, 0.2];

/// Half of the scenes have people who are close at the moment itself, an ego in a group, radii that change on the way.
#[test]
fn monte_carlo_agrees() {
    let cases: Vec<RiskCase> = serde_json::from_str(include_str!("../../tests/reference/risk.json")).unwrap();
    let mut errors = Vec::new();
    let mut compare = |name: &str, found: &[f64], expected: &[f64]| {
        assert!(close(found, expected, 0.04), "{name}: {found:?} {expected:?}");
        errors.extend(found.iter().zip(expected).map(|(a, b)| (a - b).abs()));
    };
    for case in &cases {
        let (crowd, plans) = (futures(&case.starts, &case.velocities, &case.weights, &case.scales), [plan(&case.plan)]);
        let crowd = with_deviation(&crowd, case.deviation);
        for (name, expected, risks) in [
            ("unseen", &case.unseen, crowd.risks(&plans, case.within, case.ego)),
            ("seen", &case.seen, crowd.risks_if_seen(&plans, case.within, case.ego)),
        ] {
            let risk = risks.unwrap().remove(0);
            assert!(close(&[risk.total], &risk.until[11..], 0.0));
            compare(name, &[&risk.pedestrians[..], &risk.steps, &risk.until].concat(), expected);
        }
        let clearance = crowd.clearances(&plans).unwrap().remove(0);
        compare("clearances", &clearance.pedestrians, &case.clearances);
        compare("nearest", &[clearance.nearest], &[case.nearest]);
    }
    let mean = errors.iter().sum::<f64>() / errors.len() as f64;
    assert!(mean < 0.0055, "{mean}");
}

/// Two walk side by side at 1.2 m/s, 0.8 m apart; either may stop. The companion of who follows the plan goes on as it
/// does, and keeps its distance; a stranger at the same place may come close.
#[test]
fn companions_go_on_as_the_plan_does() {
    let walk = |x: f64| -> Vec<Position> { (0..OBSERVED).map(|t| [x, 0.48 * (t as f64 - 7.0)]).collect() };
    let window = |other: f64| {
        let ids = vec![PedestrianId(1), PedestrianId(2)];
        Window::new("yard", 0, 10, ids, vec![walk(0.0), walk(other)]).unwrap()
    };
    let hypothesis = |x: f64, speed: f64| (1..=HORIZON).map(move |t| [x, speed * 0.4 * t as f64]);
    let of_both = |other: f64| {
        let of_each = [0.0, other].map(|x| [1.2, 0.0].map(|speed| hypothesis(x, speed)));
        let positions = of_each.into_iter().flatten().flatten().collect();
        let spread = Spread {
            scales: vec![0.15; 2 * HORIZON],
            paces: vec![Pace::Walking; 2],
            regions: RegionTable::of(&[&[[1.0; HORIZON]; 9]; 3], &[0.5]).unwrap().into(),
        };
        let forecast = Forecast::new(2, 2, positions, vec![0.5; 4], None).unwrap().with_spread(spread).unwrap();
        Futures::new(&window(other), forecast, None).unwrap()
    };
    let there = plan(&[[0.0; 4], [4.8, 0.0, 1e7, 0.0]]);
    let risk = of_both(0.8).risks_if_seen(&[there], 0.5, Some(0)).unwrap().remove(0);
    assert!((0.0..=1.0).contains(&risk.total), "{risk:?}");
    // The plan goes on, or stops after 1 m.
    for (rows, stops) in
        [([[0.0, 0.0, 0.0, 0.0], [4.8, 0.0, 5.76, 0.0]], false), ([[0.0; 4], [1.0, 0.0, 1.0, 0.0]], true)]
    {
        let plan = [plan(&rows)];
        let beside = of_both(0.8);
        let [seen, unseen] = [
            beside.risks_if_seen(&plan, 0.5, Some(0)).unwrap().remove(0),
            beside.risks(&plan, 0.5, Some(0)).unwrap().remove(0),
        ];
        assert!(seen.total < 0.5 * unseen.total && seen.total > 0.0, "{stops}: {} {}", seen.total, unseen.total);
    }
}

/// Of twenty equal hypotheses of a companion one remains: the risk is its own, and the same however all are turned.
#[test]
fn the_hypothesis_that_gains_all_weight_has_an_accurate_risk() {
    let of_angle = |angle: f64| {
        let (sin, cos) = angle.sin_cos();
        let turned = |[x, y]: Position| [cos * x - sin * y, sin * x + cos * y];
        let past = |x: f64| -> Vec<Position> { (0..OBSERVED).map(|t| turned([x, 0.48 * (t as f64 - 7.0)])).collect() };
        let ids = vec![PedestrianId(1), PedestrianId(2)];
        let window = Window::new("yard", 0, 10, ids, vec![past(0.0), past(0.8)]).unwrap();
        // One stops after a metre; the others go on, some faster than others.
        let path = |x: f64, k: usize| {
            (1..=HORIZON).map(move |t| {
                let way = 0.48 * t as f64;
                [x, if k == 0 { way.min(1.0) } else { way * (0.9 + 0.01 * k as f64) }]
            })
        };
        let positions = [0.0, 0.8].iter().flat_map(|&x| (0..20).flat_map(move |k| path(x, k))).map(turned).collect();
        let spread = Spread {
            scales: vec![0.15; 2 * HORIZON],
            paces: vec![Pace::Walking; 2],
            regions: RegionTable::of(&[&[[1.0; HORIZON]; 9]; 3], &[0.5]).unwrap().into(),
        };
        let forecast = Forecast::new(2, 20, positions, vec![0.05; 40], None).unwrap().with_spread(spread).unwrap();
        let [end, zero] = [turned([0.0, 1.0]), [0.0; 2]];
        let plan = plan(&[[0.0, zero[0], zero[1], 0.0], [1.0, end[0], end[1], 0.0]]);
        let futures = Futures::new(&window, forecast, None).unwrap();
        futures.risks_if_seen(&[plan], 0.5, Some(0)).unwrap().remove(0).total
    };
    let totals: Vec<f64> = (0..12).map(|turn| of_angle(0.5 * f64::from(turn))).collect();
    let [least, most] = [totals.iter().copied().fold(1.0, f64::min), totals.iter().copied().fold(0.0, f64::max)];
    assert!(least > 0.005 && most - least < 0.02, "{totals:?}");
}

#[test]
fn what_cannot_be_asked_is_refused() {
    let futures = futures(&[[0.0; 2]], &[vec![[1.0, 0.0]]], &[1.0], &[0.5]);
    for within in [-0.1, f64::NAN, f64::INFINITY] {
        let refused = futures.risks(&[], within, None).unwrap_err().to_string();
        assert!(refused.starts_with("the distance that counts as close is "), "{refused}");
    }
    for within in [1e9, 1e19, 1e38, 1e300] {
        assert_eq!(one(&futures, &plan(&[[0.0; 4]]), within).total.to_bits(), 1.0_f64.to_bits(), "{within}");
    }
    let touched = futures.clearances(&[plan(&[[0.0, 0.0, 0.0, 100.0]])]).unwrap().remove(0);
    assert!(touched.nearest.is_sign_positive() && touched.nearest < 1e-300, "{touched:?}");
    let window = Window::new("yard", 0, 10, vec![PedestrianId(1)], vec![vec![[0.0; 2]; 8]]).unwrap();
    let bare = Forecast::with_equal_weights(1, 1, vec![[0.0; 2]; 12]).unwrap();
    let bare = Futures::new(&window, bare, None).unwrap();
    assert_eq!(bare.risks(&[], 0.5, None), Err(SceneError::NoSpread));
    assert_eq!(bare.clearances(&[]), Err(SceneError::NoSpread));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(40))]

    /// The search agrees with distances by their definition, except where they are equal to the limit.
    #[test]
    fn nothing_close_is_missed(
        (starts, velocities, scales, rows) in scenes(), within in 0.0..1.0f64, now in 0.0..0.5f64, far in any::<bool>(),
    ) {
        let shift = if far { 3e5 } else { 0.0 };
        let starts: Vec<Position> = starts.iter().map(|at| at.map(|x| x + shift)).collect();
        let rows: Vec<_> = rows.iter().map(|&[t, x, y, r]| [t, x + shift, y + shift, r]).collect();
        let (futures, plan) = (with_deviation(&futures(&starts, &velocities, &WEIGHTS, &scales), now), plan(&rows));
        let crowd = CrowdAtRisk::new(&futures).unwrap();
        let sweep = crowd.sweep(&plan, within);
        let quadratures = [0, 1, 2].map(deviations_of_hypothesis);
        // Times between which everything moves straight, by step.
        let mut times: Vec<f64> = (0..=12).map(|t| 0.4 * f64::from(t)).chain(rows.iter().map(|row| row[0])).collect();
        times.sort_by(f64::total_cmp);
        let legs = |step: usize| {
            let [from, to] = [step, step + 1].map(|t| 0.4 * t as f64);
            let inside = times.windows(2).filter(move |leg| leg[0] >= from - 1e-9 && leg[1] <= to + 1e-9);
            inside.map(|leg| [leg[0], leg[1]])
        };
        for (i, k) in (0..4).flat_map(|i| (0..3).map(move |k| (i, k))) {
            let (deviations, count) = (&quadratures[k], DEVIATIONS);
            let edge = |z: usize, time: f64, r: f64| {
                let [_, px, py, _] = row_at(&rows, time);
                let scale = now * (1.0 - time / 0.4).max(0.0) + scales[i] * time / 4.8;
                let [x, y] = [0, 1].map(|axis| starts[i][axis] + time * velocities[i][k][axis]);
                (x + scale * deviations[z][0] - px).hypot(y + scale * deviations[z][1] - py) - r
            };
            let surely: [f64; 3] = std::array::from_fn(|other| f64::from(u8::from(other == k)));
            let hits = crowd.hits(&sweep, i, &surely).unwrap_or([[0.0; 2]; 2 * HORIZON]);
            let hits = hits.map(|shares| shares.map(|share| (count as f64 * share).round() as u32));
            let hits = hits.as_chunks::<HORIZON>().0;
            let mut so_far = vec![f64::INFINITY; count];
            for step in 0..HORIZON {
                let during = (0..count).map(|z| {
                    legs(step).map(|leg| {
                        let [.., radius] = row_at(&rows, f64::midpoint(leg[0], leg[1]));
                        least(leg, |time| edge(z, time, radius))
                    }).fold(f64::INFINITY, f64::min)
                });
                let during: Vec<f64> = during.collect();
                for (so_far, during) in so_far.iter_mut().zip(&during) {
                    *so_far = so_far.min(*during);
                }
                for (hits, distances) in hits.iter().zip([&during, &so_far]) {
                    // Those who were close at the moment itself, and the others.
                    let number = |limit: f64, first: bool, off: f64| {
                        let is_of = |z: &usize| (edge(*z, 0.0, rows[0][3]) <= within + off) == first;
                        (0..count).filter(|z| distances[*z] <= limit && is_of(z)).count() as u32
                    };
                    for (found, first) in hits[step].into_iter().zip([true, false]) {
                        let off = if first { 1e-5 } else { -1e-5 };
                        let [least, most] = [number(within - 1e-5, first, -off), number(within + 1e-5, first, off)];
                        prop_assert!((least..=most).contains(&found), "{found} of {least}..={most}");
                    }
                }
            }
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn laws_of_risk((starts, velocities, scales, rows) in scenes(), within in 0.0..1.0f64, more in 0.01..0.5f64) {
        let crowd = futures(&starts, &velocities, &WEIGHTS, &scales);
        let first = plan(&rows);
        let wider = plan(&rows.iter().map(|&[t, x, y, r]| [t, x, y, r + more]).collect::<Vec<_>>());
        let risk = one(&crowd, &first, within);
        for larger in [one(&crowd, &first, within + more), one(&crowd, &wider, within)] {
            prop_assert!(larger.total >= risk.total - 1e-12);
            let mut pairs = larger.pedestrians.iter().zip(&risk.pedestrians);
            prop_assert!(pairs.all(|(large, small)| *large >= small - 1e-12));
        }
        // Strangers who see the plan come close less often, and nobody more than before.
        let seen = crowd.risks_if_seen(std::slice::from_ref(&first), within, None).unwrap().remove(0);
        prop_assert!(seen.pedestrians.iter().zip(&risk.pedestrians).all(|(seen, unseen)| *seen <= unseen + 1e-12));
        prop_assert!(seen.total <= risk.total + 1e-12 && seen.until.is_sorted());
        let most = risk.pedestrians.iter().copied().fold(0.0, f64::max);
        prop_assert!(risk.total >= most - 1e-12 && risk.total <= risk.pedestrians.iter().sum::<f64>() + 1e-12);
        prop_assert!(risk.until.is_sorted() && risk.total <= 1.0 + 1e-12);
        prop_assert!(close(&risk.until[11..], &[risk.total], 0.0));
        prop_assert!(risk.steps.iter().zip(&risk.until).all(|(step, until)| *step <= until + 1e-12));
        // One by one or together, and for equal plans: the same bits.
        let plans = [wider.clone(), first.clone(), first];
        let together = crowd.risks(&plans, within, None).unwrap();
        prop_assert_eq!(&together[1..], &[risk.clone(), risk.clone()]);
        prop_assert_eq!(&together[0], &one(&crowd, &wider, within));
        // What comes after the forecast changes nothing.
        let [_, x, y, _] = row_at(&rows, 4.8);
        let until_end = rows.iter().filter(|row| row[0] < 4.8).copied();
        let [ends, goes_on] = [0.0, 9.0].map(|late| {
            let rows = until_end.clone().chain([[4.8, x, y, late], [60.0, x, y, late]]);
            plan(&rows.collect::<Vec<_>>())
        });
        prop_assert_eq!(crowd.risks_if_seen(&[ends], within, None), crowd.risks_if_seen(&[goes_on], within, None));
        let (mut starts, mut velocities, mut scales) = (starts, velocities, scales);
        starts.reverse();
        velocities.reverse();
        scales.reverse();
        let mut reversed = one(&futures(&starts, &velocities, &WEIGHTS, &scales), &plans[1], within);
        reversed.pedestrians.reverse();
        prop_assert!(close(&reversed.until, &risk.until, 1e-12) && close(&reversed.steps, &risk.steps, 1e-12));
        prop_assert!(close(&reversed.pedestrians, &risk.pedestrians, 1e-12));
    }
}
