//! Forecasts of anybody who can be observed: standing, strolling, running, turning, trembling, lost now and then. None is faster than the
//! pedestrian can be, each arrives, every certificate holds with its bounds, and none is worse than straight lines to the same goals.

use ddl::data::{Completion, HORIZON, LiveTracks, OBSERVED, PedestrianId, Position, Window};
use ddl::{BuiltinModel, CertifiedForecast, Ddl, DeviceChoice, Forecaster as _};
use ddl_tests::tiny_model;
use proptest::prelude::*;

/// Cases of the law.
const CASES: u32 = 1000;
/// Pedestrians forecast together: a case is one of them.
const TOGETHER: usize = 25;
const TIME_STEP: f64 = 0.4;

thread_local! {
    /// The built-in models, which libtorch keeps to one thread.
    static MODELS: Vec<Ddl> = {
        tiny_model::use_one_thread();
        BuiltinModel::ALL.map(|model| Ddl::builtin(model, DeviceChoice::Cpu).unwrap()).into()
    };
}

/// The fastest a forecast may be: the larger of 2.2 m/s and 1.3 times the fastest observed step and 0.5 m/s more.
fn limit(observed: &[Position]) -> f64 {
    let fastest = steps(observed).fold(0.0, f64::max);
    (1.3 * fastest + 0.5).max(2.2)
}

/// Speeds of steps, m/s.
fn steps(path: &[Position]) -> impl Iterator<Item = f64> + '_ {
    let speed =
        |pair: &[Position]| (pair[1][0] - pair[0][0]).hypot(pair[1][1] - pair[0][1]) / TIME_STEP;
    path.windows(2).map(speed)
}

/// An observation: speed, change of speed, turn a step, tremble and steps at which the position was held.
fn observation() -> impl Strategy<Value = Vec<Position>> {
    let speed = prop_oneof![1 => Just(0.0), 3 => 0.0..2.0_f64, 4 => 0.0..12.0_f64];
    let tremble = prop_oneof![2 => Just(0.0), 2 => 0.0..0.1_f64, 1 => 0.0..0.6_f64];
    let turn = prop_oneof![2 => Just(0.0), 2 => -0.5..0.5_f64, 1 => -3.1..3.1_f64];
    let noise = prop::collection::vec([-1.0..1.0_f64, -1.0..1.0_f64], OBSERVED);
    let held = prop::collection::vec(prop::bool::weighted(0.15), OBSERVED);
    let place = [-50.0..50.0_f64, -50.0..50.0_f64];
    (
        speed,
        0.6..1.4_f64,
        turn,
        tremble,
        noise,
        held,
        (place, 0.0..6.3_f64),
    )
        .prop_map(
            |(speed, faster, turn, tremble, noise, held, (place, mut heading))| {
                let (mut here, mut speed) = (place, speed);
                let mut track: Vec<Position> = Vec::new();
                for (off, held) in noise.into_iter().zip(held) {
                    let seen = [0, 1].map(|axis| here[axis] + tremble * off[axis]);
                    // A tracker that lost somebody repeats the last position.
                    track.push(if held {
                        *track.last().unwrap_or(&seen)
                    } else {
                        seen
                    });
                    here = [
                        here[0] + TIME_STEP * speed * heading.cos(),
                        here[1] + TIME_STEP * speed * heading.sin(),
                    ];
                    heading += turn;
                    speed = (speed * faster).min(12.0);
                }
                track
            },
        )
}

fn window(tracks: Vec<Vec<Position>>) -> Window {
    let ids = (0..tracks.len() as i64).map(PedestrianId).collect();
    Window::new("anybody", 0, 1, ids, tracks).unwrap()
}

fn within_bounds(
    observed: &[Position],
    certified: &CertifiedForecast,
    i: usize,
) -> Result<(), TestCaseError> {
    let forecast = &certified.forecast;
    let familiarity = forecast.familiarity(i);
    prop_assert!(
        familiarity.is_some_and(|f| f > 0.0 && f <= 1.0),
        "{familiarity:?}"
    );
    for k in 0..forecast.hypotheses() {
        let path: Vec<Position> = observed[OBSERVED - 1..]
            .iter()
            .chain(forecast.hypothesis(i, k))
            .copied()
            .collect();
        let fastest = steps(&path).fold(0.0, f64::max);
        prop_assert!(
            fastest <= limit(observed),
            "{fastest} m/s after {observed:?}"
        );
        let certificate = certified.certificate(i, k);
        prop_assert_eq!(certificate.holds(), Ok(()));
        let motion = certificate.motion().unwrap();
        prop_assert!((motion.speed.largest - fastest).abs() < 1e-6);
        prop_assert!(motion.speed.bound <= limit(observed));
        prop_assert!(motion.distance_left.is_some_and(|left| left.largest < 1e-6));
        let goal = forecast.goal(i, k).unwrap();
        let end = path[HORIZON];
        prop_assert!((goal[0] - end[0]).hypot(goal[1] - end[1]) < 1e-6);
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(CASES / TOGETHER as u32))]

    #[test]
    fn every_forecast_is_within_its_bounds(
        tracks in prop::collection::vec(observation(), TOGETHER),
        model in 0..BuiltinModel::ALL.len(),
    ) {
        let windows = [window(tracks.clone())];
        let [many, one] = MODELS.with(|models| {
            let model = &models[model];
            let many = model.forecast_certified(&windows).unwrap().remove(0);
            [many, model.forecast_one_certified(&windows).unwrap().remove(0)]
        });
        for (i, observed) in tracks.iter().enumerate() {
            within_bounds(observed, &many, i)?;
            within_bounds(observed, &one, i)?;
        }
    }
}

/// minADE of the model and of straight lines to its goals, of somebody who walks straight on at this speed, metres.
fn straight_on(model: &Ddl, speed: f64) -> [f64; 2] {
    let at = |t: usize| [TIME_STEP * speed * t as f64, 0.0];
    let forecast = model
        .forecast(&window(vec![(0..OBSERVED).map(at).collect()]))
        .unwrap();
    let start = at(OBSERVED - 1);
    let error = |place: &dyn Fn(usize, usize) -> Position| {
        let ade = |k: usize| {
            let off = |t: usize| {
                let (p, truth) = (place(k, t), at(OBSERVED + t));
                (p[0] - truth[0]).hypot(p[1] - truth[1])
            };
            (0..HORIZON).map(off).sum::<f64>() / HORIZON as f64
        };
        (0..forecast.hypotheses())
            .map(ade)
            .fold(f64::INFINITY, f64::min)
    };
    let line = |k: usize, t: usize| {
        let (goal, share) = (
            forecast.goal(0, k).unwrap(),
            (t + 1) as f64 / HORIZON as f64,
        );
        [0, 1].map(|axis| start[axis] + share * (goal[axis] - start[axis]))
    };
    [error(&|k, t| forecast.hypothesis(0, k)[t]), error(&line)]
}

#[test]
fn straight_walkers_of_every_speed_are_forecast_as_well_as_by_straight_lines() {
    MODELS.with(|models| models.iter().for_each(straight_at_every_speed));
}

fn straight_at_every_speed(model: &Ddl) {
    let mut last: Option<f64> = None;
    for speed in (1..=80).map(|tenth| 0.1 * f64::from(tenth)) {
        let [ours, lines] = straight_on(model, speed);
        let source = model.source();
        assert!(
            ours <= 1.05 * lines + 0.01,
            "{source}, {speed} m/s: {ours} m, lines {lines} m"
        );
        // No sharp edge: a tenth of a metre a second more changes the error by less than a quarter of a metre.
        if let Some(last) = last {
            assert!(
                (ours - last).abs() < 0.25,
                "{source}, {speed} m/s: from {last} to {ours} m"
            );
        }
        last = Some(ours);
    }
}

#[test]
fn whoever_runs_is_less_familiar_than_whoever_walks() {
    MODELS.with(|models| models.iter().for_each(familiar_by_speed));
}

fn familiar_by_speed(model: &Ddl) {
    let of = |speed: f64| {
        let at = |t: usize| {
            [
                TIME_STEP * speed * t as f64,
                0.02 * f64::from(u8::from(t.is_multiple_of(2))),
            ]
        };
        let walk = window(vec![(0..OBSERVED).map(at).collect()]);
        model.goal_model().familiarity(&walk)[0]
    };
    let [walks, runs, races] = [1.2, 3.5, 8.0].map(of);
    assert!(
        walks > 0.5 && runs < 0.1 && races < 0.01,
        "{walks} {runs} {races}"
    );
}

/// Who was seen twice gives no sign of walking evenly: positions before the first one seen are not evidence. The one forecast goes to the
/// median of the goals.
#[test]
fn made_up_positions_are_no_evidence() {
    MODELS.with(|models| {
        let mut tracks = LiveTracks::new().completing(Completion::USUAL);
        let pedestrian = PedestrianId(7);
        assert_eq!(tracks.push(0, [(pedestrian, [0.0, 0.0])]).unwrap(), None);
        let window = tracks.push(1, [(pedestrian, [0.1, 0.0])]).unwrap().unwrap();
        assert_eq!(window.made_up(0).padded, 6);
        for model in models {
            let windows = std::slice::from_ref(&window);
            let median = model.goal_model().goals(windows).unwrap()[0][0].median();
            let one = model.forecast_one(windows).unwrap();
            assert_eq!(one[0].goal(0, 0), Some(median), "{}", model.source());
        }
    });
}
