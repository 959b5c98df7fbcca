//! The baselines of `ddl-eval` on the real recordings are those that the literature's file says were measured.

use ddl_data::{Convention, WindowRule};
use ddl_eval::{
    Conditions, Forecaster, Protocol, ResultRow,
    baseline::{self, ConstantAcceleration, ConstantVelocity, SocialForce, StraightLine, TrueEnd},
};
use ddl_report::{Report, literature};

use crate::recordings::Recordings;

fn conditions(protocol: Protocol, fold: &str) -> Conditions {
    Conditions::new(
        Convention::Star,
        WindowRule::Published,
        protocol,
        fold,
        "baseline",
    )
}

fn measured(name: &str) -> &'static literature::MeasuredRow {
    literature::LITERATURE
        .measured
        .iter()
        .find(|row| row.method == name)
        .unwrap()
}

/// Agreement to the 3 decimals that the reference is printed with.
fn assert_printed(found: f64, expected: f64, what: &str) {
    assert!(
        (found - expected).abs() <= 0.000_501,
        "{what}: {found:.4}, expected {expected:.3}"
    );
}

#[test]
fn deterministic_baselines_agree_to_the_printed_decimals() {
    let Some(dataset) = Recordings::found() else {
        return;
    };
    let pedestrians = [2511, 1026, 24_254, 2324, 5900];
    let forecasters: [Box<dyn Forecaster>; 6] = [
        Box::new(ConstantVelocity::last_step()),
        Box::new(ConstantVelocity::mean_observed()),
        Box::new(ConstantAcceleration::unbounded()),
        Box::new(ConstantAcceleration::bounded()),
        Box::new(SocialForce),
        Box::new(StraightLine::to(TrueEnd)),
    ];
    for (f, fold) in literature::FOLDS.iter().enumerate() {
        let windows = dataset.windows(fold);
        for forecaster in &forecasters {
            let (name, conditions) = (forecaster.name(), conditions(Protocol::Published, fold));
            let row = ResultRow::measure(conditions, forecaster, &windows).unwrap();
            let (scores, expected) = (row.scores, measured(&name));
            assert_eq!(scores.pedestrians, pedestrians[f], "{fold}");
            let expected_ade = expected.ade.unwrap()[f];
            assert_printed(
                scores.min_ade,
                expected_ade,
                &format!("{name}, {fold}, ADE"),
            );
            assert_printed(
                scores.min_fde,
                expected.fde[f],
                &format!("{name}, {fold}, FDE"),
            );
        }
    }
}

/// Random: over 20 seeds the deviation is at most 0.0011 m (ADE) and 0.0026 m (FDE) on any fold, and the
/// reference is one draw too.
#[test]
fn angular_noise_agrees_within_its_spread() {
    let Some(dataset) = Recordings::found() else {
        return;
    };
    let expected = measured("constant velocity, 25 degree angular noise, best of 20");
    for (f, fold) in literature::FOLDS.iter().enumerate() {
        let windows = dataset.windows(fold);
        let noisy = ConstantVelocity::angular_noise(1);
        let row = ResultRow::measure(conditions(Protocol::Fair, fold), &noisy, &windows).unwrap();
        assert!(
            (row.scores.min_ade - expected.ade.unwrap()[f]).abs() < 0.005,
            "{fold} {row:?}"
        );
        assert!(
            (row.scores.min_fde - expected.fde[f]).abs() < 0.012,
            "{fold} {row:?}"
        );
    }
}

#[test]
fn baselines_of_five_folds_make_a_report_with_means() {
    let Some(dataset) = Recordings::found() else {
        return;
    };
    let mut rows = Vec::new();
    for fold in literature::FOLDS {
        let windows = dataset.windows(fold);
        for protocol in [Protocol::Single, Protocol::Published] {
            rows.extend(baseline::measure(&conditions(protocol, fold), &windows, 1).unwrap());
        }
    }
    let page = Report::new("Baselines", rows).unwrap().to_markdown();
    assert!(page.starts_with("Data convention: `star`"));
    // The mean of .677 .325 .525 .428 .324 and of 1.341 .615 1.166 .953 .724.
    let line = page
        .lines()
        .find(|l| l.starts_with("| constant velocity (last step)"))
        .unwrap();
    assert!(
        line.contains("0.677/1.341") && line.ends_with("| 0.456/0.960 |"),
        "{line}"
    );
}
