use super::{DEVIATIONS, crowd::Crowd, legs, quadrature::Quadrature};
use crate::fixture::{futures, plan, with_deviation};
use crate::{Futures, Plan, Risk, SceneError};
use ddl_core::{Forecast, HORIZON, Position, TIME_STEP, Window};
use proptest::{collection::vec, prelude::*};
use serde::Deserialize;

#[derive(Deserialize)]
struct Case {
    starts: Vec<Position>,
    velocities: Vec<Vec<Position>>,
    weights: Vec<f64>,
    scales: Vec<f64>,
    plan: Vec<[f64; 4]>,
    within: f64,
    pedestrians: Vec<f64>,
    steps: [f64; HORIZON],
    until: [f64; HORIZON],
    clearances: Vec<f64>,
    nearest: f64,
}

fn one(futures: &Futures, plan: &Plan, within: f64) -> Risk {
    futures
        .risks(std::slice::from_ref(plan), within, None)
        .unwrap()
        .remove(0)
}

fn close(a: &[f64], b: &[f64], tolerance: f64) -> bool {
    a.len() == b.len() && a.iter().zip(b).all(|(a, b)| (a - b).abs() <= tolerance)
}

/// `[N]` starts, `[N][3]` velocities and `[N]` scales; rows of a plan.
type Scene = (Vec<Position>, Vec<Vec<Position>>, Vec<f64>, Vec<[f64; 4]>);

/// Crowds at random places, plans of three rows.
fn scenes() -> impl Strategy<Value = Scene> {
    let place = || [-4.0..4.0f64, -4.0..4.0f64];
    let speeds = vec([-1.5..1.5f64, -1.5..1.5f64], 3);
    let rows = vec((place(), 0.0..0.6f64), 3);
    let rows = (rows, 0.1..2.3f64, 2.4..6.0f64).prop_map(|(rows, second, third)| {
        let times = [0.0, second, third].into_iter().zip(rows);
        times.map(|(time, ([x, y], radius))| [time, x, y, radius]).collect()
    });
    (vec(place(), 4), vec(speeds, 4), vec(0.02..1.0f64, 4), rows)
}

const WEIGHTS: [f64; 3] = [0.5, 0.3, 0.2];

#[test]
fn monte_carlo_agrees() {
    let cases: Vec<Case> = serde_json::from_str(include_str!("../../tests/reference/risk.json")).unwrap();
    for case in &cases {
        let futures = futures(&case.starts, &case.velocities, &case.weights, &case.scales);
        let plan = plan(&case.plan);
        let risk = one(&futures, &plan, case.within);
        let found = [&risk.pedestrians[..], &risk.steps, &risk.until].concat();
        let expected = [&case.pedestrians[..], &case.steps, &case.until].concat();
        assert!(close(&found, &expected, 0.02), "{found:?} {expected:?}");
        let clearance = futures.clearances(&[plan]).unwrap().remove(0);
        let (found, expected) = (&clearance.pedestrians, &case.clearances);
        assert!(close(found, expected, 0.03), "{found:?} {expected:?}");
        assert!((clearance.nearest - case.nearest).abs() < 0.03, "{clearance:?}");
    }
}

#[test]
fn what_cannot_be_asked_is_refused() {
    let futures = futures(&[[0.0; 2]], &[vec![[1.0, 0.0]]], &[1.0], &[0.5]);
    for within in [-0.1, f64::NAN, f64::INFINITY] {
        let refused = futures.risks(&[], within, None).unwrap_err().to_string();
        assert!(
            refused.starts_with("the distance that counts as close is "),
            "{refused}"
        );
    }
    let window = Window::new("yard", 0, 10, vec![ddl_core::PedestrianId(1)], vec![vec![[0.0; 2]; 8]]).unwrap();
    let bare = Forecast::with_equal_weights(1, 1, vec![[0.0; 2]; 12]).unwrap();
    let bare = Futures::new(&window, bare).unwrap();
    assert_eq!(bare.risks(&[], 0.5, None), Err(SceneError::NoSpread));
    assert_eq!(bare.clearances(&[]), Err(SceneError::NoSpread));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// The search agrees with distances computed without its short cuts, except where they are equal to the limit.
    #[test]
    fn nothing_close_is_missed(
        (starts, velocities, scales, rows) in scenes(), within in 0.0..1.0f64, far in prop::bool::ANY,
    ) {
        let shift = if far { 3e5 } else { 0.0 };
        let starts: Vec<Position> = starts.iter().map(|at| at.map(|x| x + shift)).collect();
        let rows: Vec<_> = rows.iter().map(|&[t, x, y, r]| [t, x + shift, y + shift, r]).collect();
        let (futures, plan) = (futures(&starts, &velocities, &WEIGHTS, &scales), plan(&rows));
        let crowd = Crowd::new(&futures).unwrap();
        let (sweep, legs) = (crowd.sweep(&plan, within), legs(&plan));
        for (i, k) in (0..4).flat_map(|i| (0..3).map(move |k| (i, k))) {
            let hits = crowd.hits(&sweep, i, k).map_or([[[0.0; 2]; HORIZON]; 2], |hits| [hits.steps, hits.until]);
            let hits = hits.map(|hits| hits.map(|[first, later]| (DEVIATIONS as f64 * (first + later)) as u32));
            for step in 0..HORIZON {
                for (hits, first) in hits.iter().zip([step, 0]) {
                    let (_, after) = legs.split_at(legs.partition_point(|leg| leg.step < first));
                    let of_legs = &after[..after.partition_point(|leg| leg.step <= step)];
                    let distances = crowd.distances(of_legs, i, k);
                    let count = |limit: f64| distances.iter().filter(|distance| **distance <= limit).count() as u32;
                    let [least, most] = [count(within - 1e-5), count(within + 1e-5)];
                    prop_assert!((least..=most).contains(&hits[step]), "{} of {least}..={most}", hits[step]);
                }
            }
        }
    }

    #[test]
    fn laws_of_risk((starts, velocities, scales, rows) in scenes(), within in 0.0..1.0f64, more in 0.01..0.5f64) {
        let crowd = futures(&starts, &velocities, &WEIGHTS, &scales);
        let first = plan(&rows);
        let wider = plan(&rows.iter().map(|&[t, x, y, r]| [t, x, y, r + more]).collect::<Vec<_>>());
        let risk = one(&crowd, &first, within);
        for larger in [one(&crowd, &first, within + more), one(&crowd, &wider, within)] {
            prop_assert!(larger.total >= risk.total - 1e-12);
            prop_assert!(larger.pedestrians.iter().zip(&risk.pedestrians).all(|(large, small)| large >= small));
        }
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
        let (mut starts, mut velocities, mut scales) = (starts, velocities, scales);
        starts.reverse();
        velocities.reverse();
        scales.reverse();
        let mut reversed = one(&futures(&starts, &velocities, &WEIGHTS, &scales), &plans[1], within);
        reversed.pedestrians.reverse();
        prop_assert!(close(&reversed.until, &risk.until, 1e-12) && close(&reversed.steps, &risk.steps, 1e-12));
        prop_assert!(close(&reversed.pedestrians, &risk.pedestrians, 1e-12));
    }

    /// The risk of a seen plan depends only on the sum of its radius and the distance.
    #[test]
    fn radius_and_distance_are_one(
        (starts, velocities, scales, rows) in scenes(), within in 0.0..0.6f64, r in 0.0..0.6f64,
    ) {
        let crowd = futures(&starts, &velocities, &WEIGHTS, &scales);
        let of = |radius: f64| plan(&rows.iter().map(|&[t, x, y, _]| [t, x, y, radius]).collect::<Vec<_>>());
        let plans = [of(r), of(0.0)];
        let disc = crowd.risks_if_seen(&plans[..1], within, None).unwrap().remove(0);
        let point = crowd.risks_if_seen(&plans[1..], within + r, None).unwrap().remove(0);
        prop_assert!(close(&disc.until, &point.until, 0.02), "{disc:?} {point:?}");
    }

    /// The risk of a seen plan is at least the probability that somebody is close at the moment itself.
    #[test]
    fn who_is_close_now_stays_a_risk((starts, velocities, scales, rows) in scenes(), deviation in 0.0..0.5f64) {
        let crowd = with_deviation(&futures(&starts, &velocities, &WEIGHTS, &scales), deviation);
        let plan = plan(&rows);
        let [x, y] = plan.at(0.0).position;
        let reach = 0.4 + plan.at(0.0).radius;
        let Quadrature { x: zx, y: zy } = Quadrature::new();
        let is_close = |i: usize, z: usize| {
            let [px, py] = crowd.present(i);
            f64::hypot(px + deviation * zx[z] - x, py + deviation * zy[z] - y) < reach - 1e-5
        };
        let now = (0..4).map(|i| (0..DEVIATIONS).filter(|&z| is_close(i, z)).count() as f64 / DEVIATIONS as f64);
        let now: Vec<f64> = now.collect();
        let [seen, unseen] = [Futures::risks_if_seen, Futures::risks].map(|risks| {
            risks(&crowd, std::slice::from_ref(&plan), 0.4, None).unwrap().remove(0)
        });
        for ((seen, unseen), now) in seen.pedestrians.iter().zip(&unseen.pedestrians).zip(&now) {
            prop_assert!(now - 1e-12 <= *seen && *seen <= unseen + 1e-12, "{now} {seen} {unseen}");
        }
        let nobody_now: f64 = now.iter().map(|close_now| 1.0 - close_now).product();
        prop_assert!(seen.total >= 1.0 - nobody_now - 1e-12 && seen.total <= unseen.total + 1e-12);
    }

    /// After its last row a plan stands: a row that says so changes nothing, and a plan cut short has the same past.
    #[test]
    fn time_of_a_plan((starts, velocities, scales, rows) in scenes(), within in 0.0..1.0f64) {
        let crowd = futures(&starts, &velocities, &WEIGHTS, &scales);
        let [short, whole] = [plan(&rows[..2]), plan(&rows)];
        let [time, x, y, radius] = rows[1];
        let standing = plan(&[rows[0], rows[1], [time + 1.0, x, y, radius]]);
        let [short, whole, standing] = [short, whole, standing].map(|plan| one(&crowd, &plan, within));
        prop_assert!(close(&short.until, &standing.until, 1e-12));
        let same = (time / TIME_STEP) as usize;
        prop_assert!(close(&short.until[..same], &whole.until[..same], 1e-12));
    }

    /// The deviations lie at fixed angles: turning a scene changes little (0.066 at most in 100,000 of these scenes).
    #[test]
    fn turned((starts, velocities, scales, rows) in scenes(), angle in 0.0..6.3f64) {
        let turn = |[x, y]: Position| [x * angle.cos() - y * angle.sin(), x * angle.sin() + y * angle.cos()];
        let turned: Vec<Vec<_>> = velocities.iter().map(|all| all.iter().map(|&v| turn(v)).collect()).collect();
        let places: Vec<_> = starts.iter().map(|&start| turn(start)).collect();
        let row = |&[time, x, y, radius]: &[f64; 4]| { let [x, y] = turn([x, y]); [time, x, y, radius] };
        let before = one(&futures(&starts, &velocities, &WEIGHTS, &scales), &plan(&rows), 0.3);
        let rows: Vec<_> = rows.iter().map(row).collect();
        let after = one(&futures(&places, &turned, &WEIGHTS, &scales), &plan(&rows), 0.3);
        prop_assert!((before.total - after.total).abs() < 0.1, "{} {}", before.total, after.total);
    }
}
