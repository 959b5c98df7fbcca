//! Under `fair`, `single` and `online`, forecasts have the same bits for any future, and forecasters that need the
//! future are refused.

use ddl::data::{Dataset, OBSERVED, Observation, Position, Recording, WINDOW, Window};
use ddl::eval::baseline::{ConstantVelocity, GoalSource, StraightLine};
use ddl::eval::leak;
use ddl::goal::{GoalEstimator, GoalEstimatorParams};
use ddl::{Answer, Ddl, ForecastError, Forecaster, Protocol, Remembering, Request, Variant, WeightedGoals};
use ddl_tests::made::Made;
use ddl_tests::{bits, crowd, drawn_model};

/// A position after the observation in another future: of a pedestrian, at a frame counted from 0, instead of this one.
type Change = fn(&Window, usize, usize, Position) -> Position;

/// Extreme futures and their names. NaN is among them, because every computation with NaN gives NaN, even a
/// multiplication by 0.
const WILD: [(&str, Change); 7] = [
    ("NaN", |_, _, _, _| [f64::NAN; 2]),
    ("the origin", |_, _, _, _| [0.0; 2]),
    ("far away", |_, i, t, _| [1e9 * (i + 1) as f64, -1e7 * t as f64]),
    ("standing still", |window, i, _, _| window.observed(i)[OBSERVED - 1]),
    ("the next pedestrian's", |window, i, t, _| window.track((i + 1) % window.len())[t]),
    ("backwards in time", |window, i, t, _| window.track(i)[WINDOW - 1 + OBSERVED - t]),
    ("slightly changed", |_, _, _, p| [p[0].next_up(), p[1].next_down()]),
];

/// Changes every single future position, one at a time, then whole futures; with direct calls and through the
/// protocols.
fn never_sees_the_future(forecaster: &dyn Forecaster) {
    let name = forecaster.name();
    let windows = crowd::windows(2, 4);
    assert_eq!(leak::find(forecaster, &windows[0]).unwrap(), None, "{name}");
    let forecasts = |windows: &[Window]| {
        let fair = Protocol::Fair.forecast(forecaster, windows).unwrap();
        let single = Protocol::Single.forecast(forecaster, windows).unwrap();
        let joint = Protocol::Joint.forecast(forecaster, windows).unwrap();
        let directly = forecaster.forecast_all(windows).unwrap();
        [fair, single, joint, directly].map(|forecasts| bits::of_all(&forecasts))
    };
    let observed: Vec<Window> = windows.iter().map(Window::without_future).collect();
    let reference = forecasts(&observed);
    for (future, change) in WILD {
        let changed = windows
            .iter()
            .map(|window| window.map_positions(|i, t, p| if t < OBSERVED { p } else { change(window, i, t, p) }));
        let changed: Vec<Window> = changed.collect();
        assert_eq!(forecasts(&changed), reference, "{name}, future: {future}");
    }
}

/// The goals of an estimator that receives whole tracks and itself selects the positions to read.
struct EstimatedGoals(GoalEstimator);

impl EstimatedGoals {
    fn with(params: GoalEstimatorParams) -> Self {
        Self(crowd::goal_estimator(params))
    }
}

impl GoalSource for EstimatedGoals {
    fn name(&self) -> String {
        "the estimated goals".to_owned()
    }

    fn goals(&self, window: &Window) -> Result<Vec<WeightedGoals>, ForecastError> {
        let goals = |i| {
            let set = self.0.estimate(window.track(i));
            let set = set.map_err(|error| ForecastError::model("goal estimator", error))?;
            Ok(WeightedGoals::new(set.goals().to_vec(), set.weights().to_vec())?)
        };
        (0..window.len()).map(goals).collect()
    }
}

#[test]
fn baselines_never_see_the_future() {
    for forecaster in
        [ConstantVelocity::LastStep, ConstantVelocity::MeanObserved, ConstantVelocity::AngularNoise { seed: 3 }]
    {
        never_sees_the_future(&forecaster);
    }
    never_sees_the_future(&StraightLine(EstimatedGoals::with(GoalEstimatorParams::default())));
}

#[test]
fn no_variant_of_the_model_sees_the_future() {
    for variant in Variant::ALL {
        let model = drawn_model::of(variant);
        never_sees_the_future(&model);
        for request in [Request::one(), Request::joint()] {
            let forecasts = |windows: &[Window]| {
                Ok(model.forecast(windows, &request)?.into_iter().map(Answer::into_forecast).collect())
            };
            never_sees_the_future(&Made(forecasts));
        }
    }
}

#[test]
fn forecasters_that_read_the_future_are_detected() {
    let params = [GoalEstimatorParams::published(), GoalEstimatorParams::default()];
    let [published, fair] = params.map(|params| StraightLine(EstimatedGoals::with(params)));
    // Only its forecasts reveal that it uses the published goals if there is a future.
    let of_window = |window: &Window| if window.has_future() { &published } else { &fair }.forecast(window);
    let forecaster = Made(|windows: &[Window]| windows.iter().map(of_window).collect());
    assert!(leak::find(&forecaster, &crowd::windows(1, 4)[0]).unwrap().is_some());
}

#[test]
fn forecasters_that_need_the_future_are_refused() {
    let windows = crowd::windows(1, 6);
    let goals = EstimatedGoals::with(GoalEstimatorParams::published());
    let error = goals.0.estimate(windows[0].observed(0)).unwrap_err();
    assert!(error.to_string().contains('9'), "{error}");
    let published = StraightLine(goals);
    assert!(leak::find(&published, &windows[0]).is_err());
    assert!(Protocol::Published.forecast(&published, &windows).is_ok());
    for protocol in [Protocol::Fair, Protocol::Single, Protocol::Joint] {
        assert!(protocol.forecast(&published, &windows).is_err());
    }
}

/// The recording with other positions of all pedestrians after a frame.
fn scrambled_after(recording: &Recording, last: i64) -> Recording {
    let everything = recording.frames().iter().flat_map(|&f| recording.at(f));
    let seen = everything.map(|seen| {
        let mut position = seen.position;
        if seen.frame > last {
            // Different in each frame, so that no motion persists.
            let angle = seen.frame as f64;
            position = [position[0] + 5.0 * angle.sin(), 3.0 * angle.cos() - position[1]];
        }
        Observation { position, ..*seen }
    });
    Recording::new(recording.name(), recording.frame_step(), seen.collect()).unwrap()
}

/// Forecasts under `online` of the observed part of a window whose recording is scrambled after a frame.
fn online(model: &Ddl, window: &Window, last: i64) -> Vec<Vec<u64>> {
    let dataset = crowd::dataset();
    let recording = scrambled_after(dataset.recording(window.recording()).unwrap(), last);
    let dataset = Dataset::own(vec![recording]).unwrap();
    let windows = [window.without_future()];
    let windows = model.goal_model().remembering(&windows, &dataset, Remembering::Online).unwrap();
    assert!(!windows[0].remembered(0).is_empty());
    bits::of_all(&Protocol::Online.forecast(model, &windows).unwrap())
}

#[test]
fn remembered_tracks_never_contain_the_future() {
    let model = drawn_model::of(Variant::Full);
    for window in crowd::windows(4, 9).iter().skip(1) {
        let now = window.frames()[OBSERVED - 1];
        let never = i64::MAX;
        let forecast = online(&model, window, never);
        // At the last observed frame, only the 8 observed positions are known.
        let step = window.frame_step();
        assert_eq!(online(&model, window, now - step), forecast);
        // The past has an effect.
        assert_ne!(online(&model, window, now - 20 * step), forecast);
    }
}
