//! What forecasts refuse, by typed errors.

use super::scenes::{WINDOWS, goals};
use ddl_data::{Position, Window};
use ddl_network::{
    ForecastWindows as _, Frame, MotionNetwork, NetworkError, Noise, ProposalConfig,
    ProposalNetwork, StarConfig, StepRule, Variant,
};

/// The question that has to be refused, with what its error says.
fn refuse(
    windows: &[Window],
    goals: &[Vec<Vec<Position>>],
    noise: Noise,
    shares: Option<&[Vec<f64>]>,
    said: &str,
) {
    let config = StarConfig {
        feed_forward_width: 16,
        ..StarConfig::published(Variant::Full)
    };
    let network = MotionNetwork::new(config, 5).unwrap();
    let error = network
        .forecast_windows(windows, goals, noise, StepRule::Bounded, shares)
        .unwrap_err();
    assert!(matches!(error, NetworkError::Shape { .. }), "{error}");
    assert!(error.to_string().contains(said), "{error}");
}

#[test]
fn goals_noise_and_shares_that_do_not_fit_the_windows() {
    let windows: Vec<Window> = WINDOWS.iter().take(6).map(Window::without_future).collect();
    let goals: Vec<_> = WINDOWS
        .iter()
        .take(6)
        .map(|window| goals(window, 3))
        .collect();
    let expected = Noise::Expected;
    let draws = |count| Noise::Draws { count, seed: 1 };
    refuse(
        &windows,
        &goals[1..],
        expected,
        None,
        "goals of 6 windows, got 5",
    );
    refuse(&windows, &goals, draws(2), None, "3 goals, 2 noise vectors");
    refuse(&windows, &goals, draws(0), None, "0 noise vectors");
    let mut uneven = goals.clone();
    uneven[2][0].pop();
    refuse(
        &windows,
        &uneven,
        expected,
        None,
        "3 goals for every pedestrian, got 2",
    );
    uneven = goals.clone();
    uneven[1].pop();
    refuse(&windows, &uneven, expected, None, "pedestrians in");
    let none: Vec<_> = goals
        .iter()
        .map(|goals| vec![vec![]; goals.len()])
        .collect();
    refuse(
        &windows,
        &none,
        expected,
        None,
        "goals for every pedestrian, got 0",
    );

    let shares: Vec<Vec<f64>> = windows
        .iter()
        .map(|window| vec![1.0; window.len()])
        .collect();
    let of = "a share from 0 to 1 for every pedestrian of 6 windows";
    refuse(&windows, &goals, expected, Some(&shares[1..]), of);
    let mut wrong = shares.clone();
    wrong[3].pop();
    refuse(&windows, &goals, expected, Some(&wrong), of);
    for share in [-0.1, 1.1, f64::NAN] {
        wrong = shares.clone();
        wrong[5][0] = share;
        refuse(&windows, &goals, expected, Some(&wrong), &share.to_string());
    }
}

#[test]
fn configurations_out_of_range() {
    let own = StarConfig {
        frame: Frame::Goal,
        ..StarConfig::published(Variant::NoGoalShift)
    };
    let error = MotionNetwork::new(own, 1).unwrap_err();
    let NetworkError::Config { field: "frame", .. } = error else {
        panic!("{error}")
    };
    let headless = ProposalConfig {
        heads: 0,
        ..ProposalConfig::default()
    };
    let error = ProposalNetwork::new(headless, 1).unwrap_err();
    let NetworkError::Config { field: "heads", .. } = error else {
        panic!("{error}")
    };
}

#[test]
fn weights_of_another_network() {
    let network = |variant| {
        let config = StarConfig {
            feed_forward_width: 16,
            ..StarConfig::published(variant)
        };
        MotionNetwork::new(config, 1).unwrap()
    };
    let others = network(Variant::Star).weights().clone();
    let error = network(Variant::Full)
        .with_weights(others.clone())
        .unwrap_err();
    assert!(matches!(error, NetworkError::Shape { .. }), "{error}");
    let proposals = ProposalNetwork::new(ProposalConfig::default(), 1).unwrap();
    let error = proposals.with_weights(others).unwrap_err();
    assert!(matches!(error, NetworkError::Shape { .. }), "{error}");
}
