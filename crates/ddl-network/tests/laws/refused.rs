//! What forecasts refuse, by typed errors.

use super::scenes::{WINDOWS, goals};
use ddl_data::{Position, Window};
use ddl_network::{
    ForecastWindows as _, MotionNetwork, NetworkError, NetworkFrame, Noise, ProposalConfig,
    ProposalNetwork, StarConfig, StepRule, Variant,
};

type Goals = Vec<Vec<Position>>;

fn network(variant: Variant) -> MotionNetwork {
    let config = StarConfig {
        feed_forward_width: 16,
        ..StarConfig::published(variant)
    };
    MotionNetwork::new(config, 5).unwrap()
}

#[test]
fn goals_noise_and_shares_that_do_not_fit_the_windows() {
    let network = network(Variant::Full);
    let windows: Vec<Window> = WINDOWS.iter().take(6).map(Window::without_future).collect();
    let whole = WINDOWS.iter().take(6);
    let goals: Vec<_> = whole.map(|window| goals(window, 3)).collect();
    let refuse = |goals: &[Goals], noise: Noise, shares: Option<&[Vec<f64>]>, said: &str| {
        let refused = network.forecast_windows(&windows, goals, noise, StepRule::Bounded, shares);
        let error = refused.unwrap_err();
        assert!(matches!(error, NetworkError::Shape { .. }), "{error}");
        assert!(error.to_string().contains(said), "{error}");
    };
    let draws = |count| Noise::Draws { count, seed: 1 };
    refuse(&goals, draws(2), None, "3 goals, 2 noise vectors");
    refuse(&goals, draws(0), None, "0 noise vectors");
    let bad_goals = |change: &dyn Fn(&mut Vec<Goals>), said: &str| {
        let mut goals = goals.clone();
        change(&mut goals);
        refuse(&goals, Noise::Expected, None, said);
    };
    bad_goals(&|goals| drop(goals.remove(0)), "goals of 6 windows, got 5");
    bad_goals(
        &|goals| goals[2][0].truncate(2),
        "3 goals for every pedestrian, got 2",
    );
    bad_goals(&|goals| drop(goals[1].pop()), "pedestrians in");
    let none = "goals for every pedestrian, got 0";
    bad_goals(
        &|goals| goals.iter_mut().flatten().for_each(Vec::clear),
        none,
    );

    let bad_shares = |change: &dyn Fn(&mut Vec<Vec<f64>>), said: &str| {
        let mut shares: Vec<_> = windows
            .iter()
            .map(|window| vec![1.0; window.len()])
            .collect();
        change(&mut shares);
        refuse(&goals, Noise::Expected, Some(&shares), said);
    };
    let of = "a share from 0 to 1 for every pedestrian of 6 windows";
    bad_shares(&|shares| drop(shares.remove(0)), of);
    bad_shares(&|shares| shares[3].clear(), of);
    for share in [-0.1, 1.1, f64::NAN] {
        bad_shares(&|shares| shares[5][0] = share, &share.to_string());
    }
}

#[test]
fn configurations_out_of_range() {
    let own = StarConfig {
        frame: NetworkFrame::Goal,
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
    let others = network(Variant::Star).weights().clone();
    let refused = network(Variant::Full).with_weights(others.clone());
    let error = refused.unwrap_err();
    assert!(matches!(error, NetworkError::Shape { .. }), "{error}");
    let proposals = ProposalNetwork::new(ProposalConfig::default(), 1).unwrap();
    let error = proposals.with_weights(others).unwrap_err();
    assert!(matches!(error, NetworkError::Shape { .. }), "{error}");
}
