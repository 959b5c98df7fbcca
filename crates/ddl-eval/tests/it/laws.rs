//! Properties of the metrics, for any forecast.

use ddl_core::{Forecast, PedestrianId, Position, Rotation, WINDOW, Window, distance};
use ddl_data::{Convention, WindowRule};
use ddl_eval::baseline::SocialForce;
use ddl_eval::metric::collision::closest_approach;
use ddl_eval::{Conditions, EvaluationError, MotionKind, Protocol, ResultRow, Scores, WindowProblem};
use proptest::{collection::vec, prelude::*};
use serde_json::Value;

use crate::generated::{self, position};

fn scene(n: usize, k: usize) -> impl Strategy<Value = (Window, Forecast)> {
    (generated::window(("made up", 0, 10), n, position()), generated::forecast(n, k, true, position()))
}

fn any_scene() -> impl Strategy<Value = (Window, Forecast)> {
    (1..5_usize, 1..6_usize).prop_flat_map(|(n, k)| scene(n, k))
}

/// Every metric, with those of whole futures.
fn scores(window: &Window, forecast: &Forecast) -> Scores {
    let conditions = Conditions::new(Convention::Star, WindowRule::Complete, Protocol::Joint, "yard", "any");
    ResultRow::score(conditions, std::slice::from_ref(window), std::slice::from_ref(forecast)).unwrap().scores
}

/// All numbers except angles: lengths, shares and densities, which do not change under motions of the plane.
fn invariants(scores: &Scores) -> Vec<f64> {
    fn numbers(value: Value, numbers_so_far: &mut Vec<f64>) {
        match value {
            Value::Number(number) => numbers_so_far.extend(number.as_f64()),
            Value::Array(all) => {
                for value in all {
                    numbers(value, numbers_so_far);
                }
            }
            Value::Object(fields) => {
                let lengths = fields.into_iter().filter(|(name, _)| name != "largest_turn");
                lengths.for_each(|(_, value)| numbers(value, numbers_so_far));
            }
            _ => {}
        }
    }
    let mut numbers_of_scores = Vec::new();
    numbers(serde_json::to_value(scores).unwrap(), &mut numbers_of_scores);
    numbers_of_scores
}

/// Agreement up to rounding, which a narrow distribution magnifies.
fn all_agree(a: &[f64], b: &[f64]) -> bool {
    a.len() == b.len() && a.iter().zip(b).all(|(a, b): (&f64, &f64)| (a - b).abs() < 1e-9 + 1e-8 * a.abs())
}

/// Some of the hypotheses of every pedestrian, with positions and goals moved; equal weights unless all are taken.
fn rebuilt(forecast: &Forecast, order: &[usize], by: impl Fn(Position) -> Position) -> Forecast {
    let (n, k) = (forecast.pedestrians(), order.len());
    let pairs = || (0..n).flat_map(|i| order.iter().map(move |&h| (i, h)));
    let path = |(i, h)| forecast.hypothesis(i, h).iter().map(|p| by(*p));
    let takes_every = k == forecast.hypotheses();
    let weight = |(i, h)| {
        if takes_every { forecast.weight(i, h) } else { 1.0 / k as f64 }
    };
    let goals = pairs().map(|(i, h)| forecast.goal(i, h).map(&by)).collect();
    Forecast::new(n, k, pairs().flat_map(path).collect(), pairs().map(weight).collect(), goals).unwrap()
}

fn in_order(forecast: &Forecast) -> Vec<usize> {
    (0..forecast.hypotheses()).collect()
}

/// Pedestrians of up to 2 m/s who turn and change speed somewhat, near one another: of all kinds of motion.
fn walking(n: usize) -> impl Strategy<Value = Window> {
    let pedestrian = ((-3.0..3.0_f64, -3.0..3.0_f64), (0.0..0.8_f64, -3.2..3.2_f64), (-0.12..0.12_f64, 0.94..1.06_f64));
    vec(pedestrian, n).prop_map(|pedestrians| {
        let tracks = pedestrians.iter().map(|&((x, y), (mut speed, mut heading), (turn, growth))| {
            let mut here = [x, y];
            let mut track = vec![here];
            for _ in 1..WINDOW {
                here = [here[0] + speed * heading.cos(), here[1] + speed * heading.sin()];
                track.push(here);
                speed = (speed * growth).min(0.8);
                heading += turn;
            }
            track
        });
        let ids = (0..).take(pedestrians.len()).map(PedestrianId).collect();
        Window::new("made up", 0, 10, ids, tracks.collect()).unwrap()
    })
}

fn motions(window: &Window) -> Vec<Option<MotionKind>> {
    (0..window.len()).map(|i| MotionKind::of(window.track(i))).collect()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn more_hypotheses_never_hurt((window, forecast) in any_scene()) {
        let whole = scores(&window, &forecast);
        for k in 1..=forecast.hypotheses() {
            let fewer = scores(&window, &rebuilt(&forecast, &in_order(&forecast)[..k], |p| p));
            prop_assert!(whole.min_ade <= fewer.min_ade && whole.min_fde <= fewer.min_fde);
            prop_assert!(whole.joint_ade <= fewer.joint_ade && whole.joint_fde <= fewer.joint_fde);
            prop_assert!(whole.miss_rate <= fewer.miss_rate);
            prop_assert!(whole.miss_rate_1m <= fewer.miss_rate_1m);
            prop_assert!(whole.miss_rate_2m <= fewer.miss_rate_2m);
            for (whole, fewer) in whole.categories.iter().zip(&fewer.categories) {
                prop_assert_eq!(whole.category, fewer.category);
                prop_assert!(whole.min_ade <= fewer.min_ade && whole.min_fde <= fewer.min_fde);
            }
        }
    }

    #[test]
    fn certificates_are_counted_and_change_nothing_else(
        (window, forecast) in any_scene(),
        verdicts in vec(any::<bool>(), 20),
    ) {
        let pairs = forecast.pedestrians() * forecast.hypotheses();
        let verdicts = verdicts[..pairs].to_vec();
        let held = verdicts.iter().filter(|&&held| held).count();
        let certified = forecast.clone().with_certified(verdicts).unwrap();
        let mut counted = scores(&window, &certified);
        let share = counted.stability.as_mut().unwrap().certified.take().unwrap();
        prop_assert!((share * pairs as f64 - held as f64).abs() < 1e-9);
        prop_assert_eq!(counted, scores(&window, &forecast));
        let mixed = Scores::evaluate(&[window.clone(), window], &[certified, forecast]);
        let refused = matches!(
            mixed,
            Err(EvaluationError::Window { problem: WindowProblem::CertificatesOfSome, .. })
        );
        prop_assert!(refused);
    }

    #[test]
    fn no_metric_depends_on_where_the_world_begins(
        (window, forecast) in any_scene(),
        angle in 0.0..std::f64::consts::TAU,
        [dx, dy] in position(),
    ) {
        let rotation = Rotation::new(angle);
        let motion = |p: Position| {
            let [x, y] = rotation.apply(p);
            [x + dx, y + dy]
        };
        let before = scores(&window, &forecast);
        let after = scores(
            &window.map_positions(|_, _, p| motion(p)),
            &rebuilt(&forecast, &in_order(&forecast), motion),
        );
        let (actual, expected) = (invariants(&after), invariants(&before));
        prop_assert!(all_agree(&actual, &expected), "{actual:?} {expected:?}");
        let turn = |s: &Scores| s.stability.unwrap().largest_turn;
        prop_assert!((turn(&before) - turn(&after)).abs() < 1e-5);
    }

    #[test]
    fn perfect_forecasts_score_zero((window, _) in any_scene()) {
        let n = window.len();
        let truth = (0..n).flat_map(|i| window.future(i)).copied().collect();
        let ends = (0..n).map(|i| window.end(i)).collect();
        let perfect = Forecast::new(n, 1, truth, vec![1.0; n], ends).unwrap();
        let scores = scores(&window, &perfect);
        let zero = [
            scores.min_ade, scores.min_fde, scores.fde_at_min_ade, scores.joint_ade,
            scores.joint_fde, scores.miss_rate, scores.goal_fde.unwrap(),
            scores.stability.unwrap().end_distance, scores.ade_at_min_fde.unwrap(),
            scores.expected_ade.unwrap(), scores.expected_fde.unwrap(),
            scores.most_likely_ade.unwrap(), scores.most_likely_fde.unwrap(),
            scores.miss_rate_1m.unwrap(), scores.miss_rate_2m.unwrap(),
        ];
        prop_assert!(zero.into_iter().all(|metric| metric.abs() < 1e-9), "{zero:?}");
        prop_assert!(all_agree(&[scores.collision_rate], &[scores.true_collision_rate]));
        let against_truth = scores.true_neighbour_collision_rate.unwrap();
        prop_assert!(all_agree(&[against_truth], &[scores.true_collision_rate]));
        let several = [scores.kde_nll, scores.amd, scores.amv, scores.diversity, scores.end_diversity];
        prop_assert_eq!(several, [None; 5]);
    }

    /// All hypotheses equal the truth: the narrowest possible distribution, (1 cm)^2 in all directions, with the truth
    /// at its centre.
    #[test]
    fn certain_and_right_is_the_best_distribution((window, _) in any_scene(), k in 2..6_usize) {
        let n = window.len();
        let truth: Vec<Position> =
            (0..n).flat_map(|i| window.future(i).repeat(k)).collect();
        let scores = scores(&window, &Forecast::with_equal_weights(n, k, truth).unwrap());
        let highest = -(std::f64::consts::TAU * 1e-4).ln();
        prop_assert!((scores.kde_nll.unwrap() + highest).abs() < 1e-9);
        prop_assert!(scores.amd.unwrap() < 1e-9);
        prop_assert!((scores.amv.unwrap() - 1e-4).abs() < 1e-12);
        prop_assert_eq!((scores.diversity, scores.end_diversity), (Some(0.0), Some(0.0)));
    }

    #[test]
    fn the_order_of_the_hypotheses_does_not_matter(
        (window, forecast) in any_scene(),
        keys in vec(any::<u32>(), 6),
    ) {
        let mut order = in_order(&forecast);
        order.sort_by_key(|&k| keys[k]);
        let actual = invariants(&scores(&window, &rebuilt(&forecast, &order, |p| p)));
        let expected = invariants(&scores(&window, &forecast));
        prop_assert!(all_agree(&actual, &expected), "{actual:?} {expected:?}");
    }

    #[test]
    fn one_future_for_all_is_never_better_than_one_each((window, forecast) in any_scene()) {
        let s = scores(&window, &forecast);
        prop_assert!(s.joint_ade >= s.min_ade - 1e-12 && s.joint_fde >= s.min_fde - 1e-12);
        let joint = s.joint.unwrap();
        prop_assert!(all_agree(&[joint.ade_windows, joint.fde_windows], &[s.joint_ade, s.joint_fde]));
        if window.len() == 1 {
            prop_assert!(all_agree(&[s.joint_ade, s.joint_fde], &[s.min_ade, s.min_fde]));
        }
        prop_assert!(all_agree(&[joint.collisions.truth], &[s.true_collision_rate]));
    }

    #[test]
    fn the_whole_lies_between_its_best_and_its_bounds((window, forecast) in any_scene()) {
        let s = scores(&window, &forecast);
        prop_assert!(s.min_ade <= s.expected_ade.unwrap() + 1e-12);
        prop_assert!(s.min_fde <= s.expected_fde.unwrap() + 1e-12);
        prop_assert!(s.min_ade <= s.most_likely_ade.unwrap());
        prop_assert!(s.min_ade <= s.ade_at_min_fde.unwrap());
        prop_assert!(s.miss_rate >= s.miss_rate_1m.unwrap());
        prop_assert!(s.miss_rate_1m >= s.miss_rate_2m);
        if let Some(nll) = s.kde_nll {
            let highest = -(std::f64::consts::TAU * 1e-4).ln();
            prop_assert!((-highest - 1e-9..=20.0).contains(&nll));
            prop_assert!(s.amv.unwrap() >= 1e-4 - 1e-12 && s.amd.unwrap() >= 0.0);
        }
    }

    #[test]
    fn motions_of_a_moved_mirror_image_are_mirrored(
        window in walking(4),
        angle in 0.0..std::f64::consts::TAU,
        [dx, dy] in position(),
    ) {
        use MotionKind::{TurningLeft, TurningRight};
        let rotation = Rotation::new(angle);
        let moved = motions(&window.map_positions(|_, _, [x, y]| {
            let [x, y] = rotation.apply([x, -y]);
            [x + dx, y + dy]
        }));
        let mirrored = motions(&window).into_iter().map(|kind| match kind {
            Some(TurningLeft) => Some(TurningRight),
            Some(TurningRight) => Some(TurningLeft),
            other => other,
        });
        prop_assert_eq!(moved, mirrored.collect::<Vec<_>>());
    }

    #[test]
    fn closest_approach_is_the_minimum_over_time(
        a in vec(position(), 4),
        b in vec(position(), 4),
    ) {
        let exact = closest_approach(&a, &b);
        let mut sampled = f64::INFINITY;
        for t in 0..3 {
            for s in 0..=400 {
                let s = f64::from(s) / 400.0;
                let on = |p: &[Position]| {
                    let along = |c: usize| p[t][c] + s * (p[t + 1][c] - p[t][c]);
                    [along(0), along(1)]
                };
                sampled = sampled.min(distance(on(&a), on(&b)));
            }
        }
        // A relative step is shorter than 160 m: 1/800 of it on either side of a sample.
        prop_assert!(exact <= sampled + 1e-12 && sampled <= exact + 0.2, "{exact} {sampled}");
        prop_assert!(all_agree(&[exact], &[closest_approach(&b, &a)]));
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(32))]

    /// Who has no future is seen by the forecaster, and not scored.
    #[test]
    fn bystanders_are_seen_and_not_scored(all in walking(5), scored in 1..5_usize) {
        let some = |range: std::ops::Range<usize>| all.filter_pedestrians(|i| range.contains(&i));
        let (window, others) = (some(0..scored).unwrap(), some(scored..5));
        let seen = window.clone().with_bystanders(others);
        prop_assert_eq!(&seen.without_future(), &all.without_future());
        for protocol in [Protocol::Fair, Protocol::Single] {
            let forecast = |window: &Window| {
                protocol.forecast(&SocialForce, std::slice::from_ref(window)).unwrap().remove(0)
            };
            let (of_all, of_seen) = (forecast(&all), forecast(&seen));
            prop_assert_eq!(of_seen.pedestrians(), scored);
            prop_assert_eq!(&of_seen, &of_all.without_bystanders(&seen));
            let [with, without] = [&seen, &window].map(|window| scores(window, &of_seen));
            prop_assert_eq!(with, without);
        }
    }
}
