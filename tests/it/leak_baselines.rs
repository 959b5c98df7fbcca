//! Baselines under `fair` and `single`: whatever the future, the same forecast bit by bit.

use ddl_data::Window;
use ddl_eval::baseline::ConstantVelocity;
use ddl_eval::{Forecaster, Protocol, leak};
use ddl_goal::GoalEstimatorParams;
use ddl_tests::{bits, crowd, goal_lines, wild_future};

/// Every single future position moved, one at a time, then futures replaced as a whole: called
/// directly and through both protocols.
fn never_sees_the_future(forecaster: &dyn Forecaster, windows: &[Window]) {
    let name = forecaster.name();
    let observed: Vec<Window> = windows.iter().map(Window::without_future).collect();
    let directly = bits::of_all(&forecaster.forecast_all(&observed).unwrap());
    let under =
        |protocol: Protocol, windows: &[Window]| match protocol.forecast(forecaster, windows) {
            Ok(forecasts) => bits::of_all(&forecasts),
            Err(error) => panic!("{name}, {protocol}: {error}"),
        };
    for window in windows {
        assert_eq!(leak::find(forecaster, window).unwrap(), None, "{name}");
    }
    for change in 0..wild_future::all(&windows[0]).len() {
        let (kinds, changed): (Vec<_>, Vec<_>) = windows
            .iter()
            .map(|window| wild_future::all(window).swap_remove(change))
            .unzip();
        let kind = kinds[0];
        let seen = bits::of_all(&forecaster.forecast_all(&changed).unwrap());
        assert_eq!(seen, directly, "{name}, future: {kind}");
        for protocol in [Protocol::Fair, Protocol::Single] {
            assert_eq!(
                under(protocol, &changed),
                under(protocol, windows),
                "{name}, {protocol}, future: {kind}"
            );
        }
    }
}

#[test]
fn constant_velocity_never_sees_the_future() {
    let windows = crowd::windows(6, 8);
    for forecaster in [
        ConstantVelocity::last_step(),
        ConstantVelocity::mean_observed(),
        ConstantVelocity::angular_noise(3),
    ] {
        never_sees_the_future(&forecaster, &windows);
    }
}

#[test]
fn straight_lines_to_estimated_goals_never_see_the_future() {
    let estimator = crowd::goal_estimator(GoalEstimatorParams::default());
    never_sees_the_future(&goal_lines::to_goals_of(estimator), &crowd::windows(2, 4));
}
