//! The baselines of `ddl-eval` on the real recordings agree with the reference values in `literature.json`.

use crate::literature::{BaselineReference, FOLDS, LITERATURE};
use ddl_core::{Forecaster, Window};
use ddl_data::{Convention, Dataset, WindowRule, locate};
use ddl_eval::baseline::{ConstantAcceleration, ConstantVelocity, SocialForce, StraightLine, TrueEndpoint};
use ddl_eval::{Conditions, Protocol, ResultRow};

/// The test windows of every fold; without recordings the tests are skipped, except in CI.
fn folds() -> Option<Vec<(&'static str, Vec<Window>)>> {
    let star = Convention::Star;
    let windows = |dataset: Dataset| {
        let cut = |fold: &&'static str| (*fold, dataset.fold(fold).unwrap().test_windows(WindowRule::Published));
        FOLDS.iter().map(cut).collect()
    };
    match locate(star, None).and_then(|folder| Dataset::load(star, &folder)) {
        Ok(dataset) => Some(windows(dataset)),
        Err(why) => {
            let in_ci = std::env::var_os("CI").is_some();
            assert!(!in_ci, "CI needs the recordings: {why}");
            eprintln!("skipped, no recordings: {why}");
            None
        }
    }
}

fn measured(name: &str) -> &'static BaselineReference {
    let mut rows = LITERATURE.measured.iter();
    rows.find(|row| row.method == name).unwrap()
}

/// Deterministic baselines agree to the 3 decimals of the reference. Over 20 seeds, the deviation of angular noise is
/// at most 0.0011 m (ADE) and 0.0026 m (FDE) on any fold; the reference is also one draw.
#[test]
fn baselines_agree_to_the_printed_decimals_or_within_their_spread() {
    let Some(folds) = folds() else { return };
    let pedestrians = [2511, 1026, 24_254, 2324, 5900];
    let noisy = ConstantVelocity::AngularNoise { seed: 1 };
    let of_noise = "constant velocity, 25 degree angular noise, best of 20".to_owned();
    let deterministic: [Box<dyn Forecaster>; 5] = [
        Box::new(ConstantVelocity::LastStep),
        Box::new(ConstantVelocity::MeanObserved),
        Box::new(ConstantAcceleration),
        Box::new(SocialForce),
        Box::new(StraightLine(TrueEndpoint)),
    ];
    let printed = deterministic.into_iter().map(|forecaster| (forecaster.name(), forecaster, [0.000_501; 2]));
    let forecasters: Vec<(String, Box<dyn Forecaster>, [f64; 2])> =
        printed.chain([(of_noise, Box::new(noisy) as _, [0.005, 0.012])]).collect();
    for (f, (fold, windows)) in folds.iter().enumerate() {
        for (name, forecaster, tolerance) in &forecasters {
            let (star, rule) = (Convention::Star, WindowRule::Published);
            let conditions = Conditions::new(star, rule, Protocol::Published, *fold, "baseline");
            let scores = ResultRow::measure(conditions, forecaster, windows).unwrap().scores;
            let expected = measured(name);
            assert_eq!(scores.pedestrians, pedestrians[f], "{fold}");
            let errors = [scores.min_ade - expected.ade.unwrap()[f], scores.min_fde - expected.fde[f]];
            for (error, most) in errors.into_iter().zip(tolerance) {
                assert!(error.abs() <= *most, "{name}, {fold}: {error} m off");
            }
        }
    }
}
