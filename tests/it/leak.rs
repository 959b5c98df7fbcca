//! Forecasts and the future: whatever it is, they have the same bits under `fair` and `single`; and whoever needs it is
//! refused.

use ddl::data::{OBSERVED, Position, WINDOW, Window};
use ddl::eval::baseline::{ConstantVelocity, GoalSource, StraightLine, TrueEnd, WeightedGoals};
use ddl::eval::{Forecast, ForecastError, leak};
use ddl::goal::{GoalEstimator, GoalEstimatorParams};
use ddl::{Forecaster, Protocol, Variant};
use ddl_tests::one_forecast::One;
use ddl_tests::{bits, crowd, drawn_model};

/// The window with each position after the observation replaced by `f(pedestrian, frame, position)`, frames counted from 0.
pub(crate) fn with_future(
    window: &Window,
    f: impl Fn(usize, usize, Position) -> Position,
) -> Window {
    window.map_positions(|i, t, p| if t < OBSERVED { p } else { f(i, t, p) })
}

/// The window with futures that nobody could have, and what each is called. NaN is among them: whatever touches it, even to multiply
/// it by nothing, is NaN as well.
fn wild(window: &Window) -> Vec<(&'static str, Window)> {
    let n = window.len();
    vec![
        ("NaN", with_future(window, |_, _, _| [f64::NAN; 2])),
        ("the origin", with_future(window, |_, _, _| [0.0; 2])),
        (
            "far away",
            with_future(window, |i, t, _| [1e9 * (i + 1) as f64, -1e7 * t as f64]),
        ),
        (
            "standing still",
            with_future(window, |i, _, _| window.observed(i)[OBSERVED - 1]),
        ),
        (
            "the next pedestrian's",
            with_future(window, |i, t, _| window.track((i + 1) % n)[t]),
        ),
        (
            "backwards in time",
            with_future(window, |i, t, _| window.track(i)[WINDOW - 1 + OBSERVED - t]),
        ),
        (
            "a hair off",
            with_future(window, |_, _, p| [p[0].next_up(), p[1].next_down()]),
        ),
    ]
}

/// Every single future position moved, one at a time, then futures replaced as a whole: called directly and through both protocols.
fn never_sees_the_future(forecaster: &dyn Forecaster) {
    let name = forecaster.name();
    let windows = crowd::windows(2, 4);
    assert_eq!(leak::find(forecaster, &windows[0]).unwrap(), None, "{name}");
    let forecasts = |windows: &[Window]| {
        let fair = Protocol::Fair.forecast(forecaster, windows).unwrap();
        let single = Protocol::Single.forecast(forecaster, windows).unwrap();
        let directly = forecaster.forecast_all(windows).unwrap();
        [fair, single, directly].map(|forecasts| bits::of_all(&forecasts))
    };
    let observed: Vec<Window> = windows.iter().map(Window::without_future).collect();
    let reference = forecasts(&observed);
    let futures: Vec<_> = windows.iter().map(wild).collect();
    for change in 0..futures[0].len() {
        let changed: Vec<Window> = futures.iter().map(|of| of[change].1.clone()).collect();
        let future = futures[0][change].0;
        assert_eq!(forecasts(&changed), reference, "{name}, future: {future}");
    }
}

/// The goals of an estimator, shown whole tracks: what it reads of them is its own affair.
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
            Ok(WeightedGoals::new(
                set.goals().to_vec(),
                set.weights().to_vec(),
            )?)
        };
        (0..window.len()).map(goals).collect()
    }
}

#[test]
fn baselines_never_see_the_future() {
    for forecaster in [
        ConstantVelocity::last_step(),
        ConstantVelocity::mean_observed(),
        ConstantVelocity::angular_noise(3),
    ] {
        never_sees_the_future(&forecaster);
    }
    let goals = EstimatedGoals::with(GoalEstimatorParams::default());
    never_sees_the_future(&StraightLine::to(goals));
}

#[test]
fn no_variant_of_the_model_sees_the_future() {
    for variant in Variant::ALL {
        let model = drawn_model::of(variant);
        never_sees_the_future(&model);
        never_sees_the_future(&One(&model));
    }
}

/// The published goals where there is a future to read, others where there is none: only what it forecasts tells.
struct PublishedWhenItCan([EstimatedGoals; 2]);

impl Forecaster for PublishedWhenItCan {
    fn name(&self) -> String {
        "published goals when it can".to_owned()
    }

    fn forecast(&self, window: &Window) -> Result<Forecast, ForecastError> {
        let [published, fair] = &self.0;
        let source = if window.has_future() { published } else { fair };
        StraightLine::to(source).forecast(window)
    }
}

#[test]
fn who_reads_the_future_is_found() {
    let params = [
        GoalEstimatorParams::published(),
        GoalEstimatorParams::default(),
    ];
    let forecaster = PublishedWhenItCan(params.map(EstimatedGoals::with));
    let window = &crowd::windows(1, 4)[0];
    assert!(leak::find(&forecaster, window).unwrap().is_some());
}

#[test]
fn who_needs_the_future_is_refused() {
    let windows = crowd::windows(1, 6);
    let goals = EstimatedGoals::with(GoalEstimatorParams::published());
    let error = goals.0.estimate(windows[0].observed(0)).unwrap_err();
    assert!(error.to_string().contains('9'), "{error}");
    let (published, oracle) = (StraightLine::to(goals), StraightLine::to(TrueEnd));
    for forecaster in [&published as &dyn Forecaster, &oracle] {
        assert!(leak::find(forecaster, &windows[0]).is_err());
        assert!(Protocol::Published.forecast(forecaster, &windows).is_ok());
        for protocol in [Protocol::Fair, Protocol::Single] {
            assert!(protocol.forecast(forecaster, &windows).is_err());
        }
    }
}
