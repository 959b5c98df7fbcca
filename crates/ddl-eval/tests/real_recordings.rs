//! The baselines on the real recordings, against numbers computed independently.

#![allow(
    clippy::unwrap_used,
    reason = "a helper that fails is a test that fails"
)]

use ddl_data::{Convention, Dataset, WindowRule, locate};
use ddl_eval::{
    Category, Conditions, Forecaster, Protocol, Report, ResultRow,
    baseline::{self, ConstantAcceleration, ConstantVelocity, SocialForce, StraightLine, TrueEnd},
    category::{Interaction, TrajectoryType},
    leak, literature,
};

/// The recordings of the `star` convention; without them the test is skipped, but not in CI.
fn recordings() -> Option<Dataset> {
    let found =
        locate(Convention::Star, None).and_then(|folder| Dataset::load(Convention::Star, &folder));
    match found {
        Ok(dataset) => Some(dataset),
        Err(why) => {
            assert!(
                std::env::var_os("CI").is_none(),
                "in CI the recordings must be there: {why}"
            );
            eprintln!("skipped, the recordings are not here: {why}");
            None
        }
    }
}

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
    literature::MEASURED
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
    let Some(dataset) = recordings() else { return };
    let walkers = [2511, 1026, 24_254, 2324, 5900];
    let rows: [(&str, Box<dyn Forecaster>); 6] = [
        (
            "constant velocity (last step)",
            Box::new(ConstantVelocity::last_step()),
        ),
        (
            "constant velocity (mean observed)",
            Box::new(ConstantVelocity::mean_observed()),
        ),
        (
            "constant acceleration",
            Box::new(ConstantAcceleration::unbounded()),
        ),
        (
            "constant acceleration (bounded)",
            Box::new(ConstantAcceleration::bounded()),
        ),
        ("social force", Box::new(SocialForce)),
        (
            "straight line to the TRUE end",
            Box::new(StraightLine::to(TrueEnd)),
        ),
    ];
    for (f, fold) in literature::FOLDS.iter().enumerate() {
        let windows = dataset
            .fold(fold)
            .unwrap()
            .test_windows(WindowRule::Published);
        for (name, forecaster) in &rows {
            let conditions = conditions(Protocol::Published, fold);
            let scores = ResultRow::measure(conditions, forecaster, &windows)
                .unwrap()
                .scores;
            let expected = measured(name);
            assert_eq!(scores.pedestrians, walkers[f], "{fold}");
            assert_printed(
                scores.min_ade,
                expected.ade.unwrap()[f],
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

/// Walkers of each type, I to IV, and of each sub-kind of III, counted with numpy from the definitions in
/// the docstrings, angles by arctan2 and the filter with whole matrices.
#[test]
fn walkers_are_of_the_types_counted_independently() {
    let Some(dataset) = recordings() else { return };
    let counted = [
        [219, 484, 781, 1027, 230, 60, 356, 235],
        [660, 165, 112, 89, 7, 11, 71, 26],
        [4524, 1890, 15_189, 2651, 2584, 4569, 7127, 4442],
        [132, 431, 861, 900, 144, 138, 537, 135],
        [2767, 432, 1751, 950, 297, 301, 1048, 422],
    ];
    for (fold, expected) in literature::FOLDS.iter().zip(counted) {
        let windows = dataset
            .fold(fold)
            .unwrap()
            .test_windows(WindowRule::Published);
        let row = ResultRow::measure(
            conditions(Protocol::Single, fold),
            &ConstantVelocity::last_step(),
            &windows,
        );
        let categories = row.unwrap().scores.categories;
        let types = TrajectoryType::ALL.map(Category::Type);
        let interactions = Interaction::ALL.map(Category::Interaction);
        let count = |category| {
            let of = categories.iter().find(|c| c.category == category);
            of.map_or(0, |c| c.pedestrians)
        };
        let found: Vec<usize> = types.into_iter().chain(interactions).map(count).collect();
        assert_eq!(found, expected, "{fold}");
    }
}

/// Random: over 20 seeds the deviation is at most 0.0011 m (ADE) and 0.0026 m (FDE) on any fold, and the
/// reference is one draw too.
#[test]
fn angular_noise_agrees_within_its_spread() {
    let Some(dataset) = recordings() else { return };
    let expected = measured("constant velocity, 25 degree angular noise, best of 20");
    for (f, fold) in literature::FOLDS.iter().enumerate() {
        let windows = dataset
            .fold(fold)
            .unwrap()
            .test_windows(WindowRule::Published);
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
    let Some(dataset) = recordings() else { return };
    let mut rows = Vec::new();
    for fold in literature::FOLDS {
        let windows = dataset
            .fold(fold)
            .unwrap()
            .test_windows(WindowRule::Published);
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

#[test]
fn forecasters_that_look_ahead_are_found_out() {
    let Some(dataset) = recordings() else { return };
    let windows = dataset
        .fold("zara1")
        .unwrap()
        .test_windows(WindowRule::Published);
    let crowded = windows.iter().max_by_key(|window| window.len()).unwrap();
    let honest: [Box<dyn Forecaster>; 5] = [
        Box::new(ConstantVelocity::last_step()),
        Box::new(ConstantVelocity::mean_observed()),
        Box::new(ConstantVelocity::angular_noise(5)),
        Box::new(ConstantAcceleration::bounded()),
        Box::new(SocialForce),
    ];
    for forecaster in &honest {
        assert_eq!(leak::find(forecaster, crowded).unwrap(), None);
    }
    assert!(leak::find(&StraightLine::to(TrueEnd), crowded).is_err());
}
