//! Typed errors for invalid inputs and configurations.

use super::scenes::{WINDOWS, goals};
use ddl_core::{Position, Window};
use ddl_network::{
    ForecastWindows as _, MotionNetwork, NetworkError, NetworkFrame, Noise, ProposalConfig, ProposalNetwork,
    ProposalTraining, StarConfig, StepRule, TrainingConfig, Variant,
};

type Goals = Vec<Vec<Position>>;

fn network(variant: Variant) -> MotionNetwork {
    let config = StarConfig { feed_forward_width: 16, ..StarConfig::published(variant) };
    MotionNetwork::new(config, 5).unwrap()
}

#[test]
fn goals_noise_and_shares_that_do_not_fit_the_windows_are_refused() {
    let network = network(Variant::Full);
    let windows: Vec<Window> = WINDOWS.iter().take(6).map(Window::without_future).collect();
    let goals: Vec<_> = WINDOWS.iter().take(6).map(|window| goals(window, 3)).collect();
    let refuse = |goals: &[Goals], noise: Noise, shares: Option<&[Vec<f64>]>, expected: &str| {
        let error = network.forecast_windows(&windows, goals, noise, StepRule::Bounded, shares).unwrap_err();
        assert!(matches!(error, NetworkError::Shape { .. }), "{error}");
        assert!(error.to_string().contains(expected), "{error}");
    };
    let draws = |count| Noise::Draws { count, seed: 1 };
    refuse(&goals, draws(2), None, "3 goals, 2 noise vectors");
    refuse(&goals, draws(0), None, "0 noise vectors");
    let bad_goals = |change: &dyn Fn(&mut Vec<Goals>), expected: &str| {
        let mut goals = goals.clone();
        change(&mut goals);
        refuse(&goals, Noise::Expected, None, expected);
    };
    bad_goals(&|goals| drop(goals.remove(0)), "goals of 6 windows, got 5");
    bad_goals(&|goals| goals[2][0].truncate(2), "3 goals for every pedestrian, got 2");
    bad_goals(&|goals| drop(goals[1].pop()), "pedestrians in");
    let none = "goals for every pedestrian, got 0";
    bad_goals(&|goals| goals.iter_mut().flatten().for_each(Vec::clear), none);

    let bad_shares = |change: &dyn Fn(&mut Vec<Vec<f64>>), expected: &str| {
        let mut shares: Vec<_> = windows.iter().map(|window| vec![1.0; window.len()]).collect();
        change(&mut shares);
        refuse(&goals, Noise::Expected, Some(&shares), expected);
    };
    let rule = "a share from 0 to 1 for every pedestrian of 6 windows";
    bad_shares(&|shares| drop(shares.remove(0)), rule);
    bad_shares(&|shares| shares[3].clear(), rule);
    for share in [-0.1, 1.1, f64::NAN] {
        bad_shares(&|shares| shares[5][0] = share, &share.to_string());
    }
}

type Fault<T> = (fn(&mut T), &'static str);

fn check_all<T: Clone>(good: &T, check: fn(&T) -> Result<(), NetworkError>, faults: &[Fault<T>]) {
    check(good).unwrap();
    for (change, expected) in faults {
        let mut bad = good.clone();
        change(&mut bad);
        let error = check(&bad).unwrap_err();
        assert!(matches!(error, NetworkError::Config { .. }), "{error}");
        assert!(error.to_string().contains(expected), "{error}");
    }
}

#[test]
fn configurations_out_of_range_are_refused() {
    let published = StarConfig::published(Variant::Full);
    check_all(
        &published,
        StarConfig::check,
        &[
            (|c| c.heads = 5, "heads = 5"),
            (|c| c.heads = 4, "a quarter of model_width"),
            (|c| (c.model_width, c.heads) = (512, 512), "heads = 512"),
            (|c| c.model_width = 65_536, "at most 2^24 weights"),
            (|c| c.spatial_layers = 65, "1 to 64"),
            (|c| c.spatial_dropout = 1.0, "in [0, 1)"),
            (|c| c.sigma = 0.0, "sigma"),
            (|c| (c.variant, c.frame) = (Variant::NoGoalShift, NetworkFrame::Goal), "frame"),
        ],
    );
    check_all(
        &TrainingConfig::published(),
        |config| config.check(Variant::Full),
        &[(|c| c.epochs = usize::MAX, "epochs"), (|c| c.learning_rate = f64::NAN, "learning_rate")],
    );
    check_all(
        &ProposalConfig::default(),
        ProposalConfig::check,
        &[(|c| c.heads = 3, "heads"), (|c| c.heads = 0, "heads")],
    );
    check_all(&ProposalTraining::default(), ProposalTraining::check, &[(|c| c.turn = f64::NAN, "turn")]);
    let headless = StarConfig { heads: 0, ..published };
    MotionNetwork::new(headless, 1).unwrap_err();
}

#[test]
fn weights_of_another_network_are_refused() {
    let others = network(Variant::Star).copy_weights().unwrap();
    let config = network(Variant::Full).config().clone();
    let error = MotionNetwork::reading(config, |_| Ok(others.clone())).unwrap_err();
    assert!(matches!(error, NetworkError::Shape { .. }), "{error}");
    let error = ProposalNetwork::reading(ProposalConfig::default(), |_| Ok(others)).unwrap_err();
    assert!(matches!(error, NetworkError::Shape { .. }), "{error}");
}
