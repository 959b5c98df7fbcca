//! Forecasts of arbitrary observations: standing, strolling, running, turning, noisy, with gaps. Every forecast keeps
//! the top speed and arrives, every certificate holds with its bounds, and no forecast is worse than straight lines to
//! the same goals.

use ddl::data::{Completeness, HORIZON, LiveTracks, OBSERVED, PedestrianId, Position, Window};
use ddl::eval::metric::stability::RolloutStability;
use ddl::{
    Answer, BuiltinModel, CertificateError, Ddl, DdlError, DeviceChoice, ForecastError, Forecaster, Request, Session,
    Variant,
};
use ddl_core::distance;
use ddl_tests::place::Place;
use ddl_tests::{bits, crowd, drawn_model};
use proptest::prelude::*;
use std::sync::LazyLock;

const CASES: u32 = 1000;
/// Number of pedestrians that are forecast together; each of them is a test case.
const TOGETHER: usize = 25;
const TIME_STEP: f64 = 0.4;

/// The built-in models, and two with drawn weights.
static MODELS: LazyLock<Vec<Ddl>> = LazyLock::new(|| {
    let builtin = BuiltinModel::ALL.map(|model| Ddl::builtin(model, DeviceChoice::Cpu).unwrap());
    let drawn = [Variant::Full, Variant::NoGoalShift].map(drawn_model::of);
    builtin.into_iter().chain(drawn).collect()
});

fn builtin() -> &'static [Ddl] {
    &MODELS[..BuiltinModel::ALL.len()]
}

/// The largest allowed speed of a forecast: the larger of 2.2 m/s and 1.3 times the fastest observed step plus 0.5 m/s.
fn limit(observed: &[Position]) -> f64 {
    let fastest = steps(observed).fold(0.0, f64::max);
    (1.3 * fastest + 0.5).max(2.2)
}

fn steps(path: &[Position]) -> impl Iterator<Item = f64> + '_ {
    path.windows(2).map(|pair| distance(pair[0], pair[1]) / TIME_STEP)
}

/// An observation: speed, change of speed, turn per step, noise, and steps at which the position was held.
fn observation() -> impl Strategy<Value = Vec<Position>> {
    let speed = prop_oneof![1 => Just(0.0), 3 => 0.0..2.0_f64, 4 => 0.0..12.0_f64];
    let tremble = prop_oneof![2 => Just(0.0), 2 => 0.0..0.1_f64, 1 => 0.0..0.6_f64];
    let turn = prop_oneof![2 => Just(0.0), 2 => -0.5..0.5_f64, 1 => -3.1..3.1_f64];
    let noise = prop::collection::vec([-1.0..1.0_f64, -1.0..1.0_f64], OBSERVED);
    let held = prop::collection::vec(prop::bool::weighted(0.15), OBSERVED);
    let place = [-50.0..50.0_f64, -50.0..50.0_f64];
    (speed, 0.6..1.4_f64, turn, tremble, noise, held, (place, 0.0..6.3_f64)).prop_map(
        |(speed, faster, turn, tremble, noise, held, (place, mut heading))| {
            let (mut here, mut speed) = (place, speed);
            let mut track: Vec<Position> = Vec::new();
            for (off, held) in noise.into_iter().zip(held) {
                let seen = [0, 1].map(|axis| here[axis] + tremble * off[axis]);
                // A tracker that lost the pedestrian repeats the last position.
                track.push(if held { *track.last().unwrap_or(&seen) } else { seen });
                here = [here[0] + TIME_STEP * speed * heading.cos(), here[1] + TIME_STEP * speed * heading.sin()];
                heading += turn;
                speed = (speed * faster).min(12.0);
            }
            track
        },
    )
}

fn window(tracks: Vec<Vec<Position>>) -> Window {
    let ids = (0..tracks.len() as i64).map(PedestrianId).collect();
    Window::new("yard", 0, 1, ids, tracks).unwrap()
}

fn within_bounds(observed: &[Position], answer: &Answer, i: usize) -> Result<(), TestCaseError> {
    let forecast = answer.forecast();
    let familiarity = forecast.familiarity(i);
    prop_assert!(familiarity.is_some_and(|f| f > 0.0 && f <= 1.0), "{familiarity:?}");
    for k in 0..forecast.hypotheses() {
        let path: Vec<Position> = observed[OBSERVED - 1..].iter().chain(forecast.hypothesis(i, k)).copied().collect();
        let fastest = steps(&path).fold(0.0, f64::max);
        prop_assert!(fastest <= limit(observed), "{fastest} m/s after {observed:?}");
        let certificate = answer.certificate(i, k).unwrap();
        prop_assert_eq!(certificate.verify(), Ok(()));
        let motion = certificate.motion().unwrap();
        prop_assert!((motion.speed.largest - fastest).abs() < 1e-6);
        prop_assert!(motion.speed.bound <= limit(observed));
        prop_assert!(motion.distance_left.largest < 1e-6);
        let goal = forecast.goal(i, k).unwrap();
        let left: Vec<f64> = path.iter().map(|&position| distance(position, goal)).collect();
        let mut steps = left.windows(2);
        prop_assert!(steps.all(|pair| pair[1] < pair[0] || pair[0] == 0.0), "{left:?}");
        prop_assert!(left[HORIZON] < 1e-6);
        prop_assert!(RolloutStability::of(path[0], &path[1..], goal).decreasing);
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(CASES / TOGETHER as u32))]

    #[test]
    fn every_forecast_is_within_its_bounds(
        tracks in prop::collection::vec(observation(), TOGETHER),
        model in 0..MODELS.len(),
    ) {
        let windows = [window(tracks.clone())];
        let certified = |request: Request| {
            MODELS[model].forecast(&windows, &request.with_certificates()).unwrap().remove(0)
        };
        let (many, one) = (certified(Request::default()), certified(Request::one()));
        for (i, observed) in tracks.iter().enumerate() {
            within_bounds(observed, &many, i)?;
            within_bounds(observed, &one, i)?;
        }
    }
}

#[test]
fn the_certified_forecast_is_the_forecast() {
    let windows = crowd::windows(3, 10);
    for variant in [Variant::Full, Variant::NoGoalShift] {
        let model = drawn_model::of(variant);
        let goals = model.goal_model().goals(&windows).unwrap();
        let mut paths = Vec::new();
        for (request, hypotheses) in [(Request::default(), 20), (Request::joint(), 20), (Request::one(), 1)] {
            let plain = model.forecast(&windows, &request).unwrap();
            let certified = model.forecast(&windows, &request.with_certificates()).unwrap();
            for ((certified, plain), window) in certified.iter().zip(&plain).zip(&windows) {
                assert_eq!(bits::of(certified.forecast()), bits::of(plain.forecast()));
                assert_eq!((certified.first_violation(), plain.certificates().len()), (None, 0));
                assert_eq!(certified.certificates().len(), window.len() * hypotheses);
            }
            paths = plain;
        }
        for ((sets, one), window) in goals.iter().zip(&paths).zip(&windows) {
            for (i, set) in sets.iter().enumerate() {
                assert_eq!(one.forecast().goal(i, 0), Some(set.central(window.observed(i))));
            }
        }
    }
}

/// minADE (m) of the model and of straight lines to its goals, for a pedestrian that walks straight at this speed.
fn straight_on(model: &Ddl, speed: f64) -> [f64; 2] {
    let position_at = |t: usize| [TIME_STEP * speed * t as f64, 0.0];
    let forecast = Forecaster::forecast(model, &window(vec![(0..OBSERVED).map(position_at).collect()])).unwrap();
    let start = position_at(OBSERVED - 1);
    let error = |place: &dyn Fn(usize, usize) -> Position| {
        let ade = |k: usize| {
            let off = |t: usize| distance(place(k, t), position_at(OBSERVED + t));
            (0..HORIZON).map(off).sum::<f64>() / HORIZON as f64
        };
        (0..forecast.hypotheses()).map(ade).fold(f64::INFINITY, f64::min)
    };
    let line = |k: usize, t: usize| {
        let (goal, share) = (forecast.goal(0, k).unwrap(), (t + 1) as f64 / HORIZON as f64);
        [0, 1].map(|axis| start[axis] + share * (goal[axis] - start[axis]))
    };
    [error(&|k, t| forecast.hypothesis(0, k)[t]), error(&line)]
}

/// The error is continuous in the speed: 0.1 m/s more changes it by less than 0.25 m.
#[test]
fn straight_pedestrians_of_every_speed_are_forecast_as_well_as_by_straight_lines() {
    let speeds = (1..=80).map(|tenth| 0.1 * f64::from(tenth));
    for model in builtin() {
        let errors: Vec<[f64; 2]> = speeds.clone().map(|v| straight_on(model, v)).collect();
        let as_good = |&[ours, lines]: &[f64; 2]| ours <= 1.05 * lines + 0.01;
        let smooth = |pair: &[[f64; 2]]| (pair[1][0] - pair[0][0]).abs() < 0.25;
        let holds = errors.iter().all(as_good) && errors.windows(2).all(smooth);
        assert!(holds, "{}: {errors:?}", model.source());
    }
}

/// A pedestrian seen twice gives no evidence of uniform motion, because filled-in positions are not evidence. The
/// single forecast leads to the median of the goals.
#[test]
fn filled_in_positions_are_not_evidence() {
    let mut tracks = LiveTracks::new().with_completeness(Completeness::Partial);
    let pedestrian = PedestrianId(7);
    tracks.push(0, [(pedestrian, [0.0, 0.0])]).unwrap();
    let window = tracks.push(1, [(pedestrian, [0.1, 0.0])]).unwrap().unwrap();
    assert_eq!(window.quality(0).unseen, 6);
    for model in builtin() {
        let windows = std::slice::from_ref(&window);
        let median = model.goal_model().goals(windows).unwrap()[0][0].median();
        let one = model.forecast(windows, &Request::one()).unwrap();
        assert_eq!(one[0].forecast().goal(0, 0), Some(median), "{}", model.source());
    }
}

#[test]
fn models_without_a_flow_are_refused() {
    for variant in [Variant::Star, Variant::NoDynamics] {
        let place = Place::with_variant(variant);
        let forecast = "forecast --model run tracks.csv --certificate";
        place.fails(forecast, &[&format!("`{variant}`"), "no flow to certify"]);
        let model = drawn_model::of(variant);
        let no_flow = |error: ForecastError| {
            let ForecastError::Model { source, .. } = error else { panic!("{error}") };
            let expected = CertificateError::NoFlow { variant };
            assert_eq!(source.downcast_ref::<CertificateError>(), Some(&expected));
        };
        let request = Request::default().with_certificates();
        no_flow(model.forecast(&crowd::windows(1, 2), &request).unwrap_err());
        match Session::new(&model, LiveTracks::new(), request).unwrap_err() {
            DdlError::Forecast(error) => no_flow(error),
            other => panic!("{other:?}"),
        }
    }
}
