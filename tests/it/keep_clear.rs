//! `--keep-clear`: pedestrians avoid each other, and every certificate still holds.

use ddl::data::{PedestrianId, Window};
use ddl::eval::metric::collision::closest_approach;
use ddl::report::Report;
use ddl::{
    CertificateError, Clearance, Ddl, DdlError, Forecast, ForecastError, Forecaster as _, LiveForecaster, Variant,
};
use ddl_tests::place::Place;
use ddl_tests::{crowd, drawn_model};

/// Pairs of pedestrians in one window whose most likely forecasts come closer than `distance`.
fn near_pairs(windows: &[Window], forecasts: &[Forecast], distance: f64) -> usize {
    let likeliest = |forecast: &Forecast, i| forecast.hypothesis(i, forecast.most_likely(i)).to_vec();
    windows
        .iter()
        .zip(forecasts)
        .map(|(window, forecast)| {
            let pairs = (0..window.len()).flat_map(|j| (0..j).map(move |i| (i, j)));
            pairs
                .filter(|&(i, j)| {
                    let (one, other) = (likeliest(forecast, i), likeliest(forecast, j));
                    closest_approach(&one, &other) < distance
                })
                .count()
        })
        .sum()
}

fn free_and_careful() -> [Ddl; 2] {
    let clearance = Clearance::new(0.5).unwrap();
    let [free, careful] = [0, 1].map(|_| drawn_model::of(Variant::Full));
    [free, careful.with_clearance(clearance).unwrap()]
}

#[test]
fn fewer_pairs_come_close_and_all_arrive() {
    let windows = crowd::windows(12, 12);
    let [free, careful] = free_and_careful();
    let certified = careful.forecast_certified(&windows).unwrap();
    assert!(certified.iter().all(|one| one.first_violation().is_none()));
    let clear: Vec<Forecast> = certified.into_iter().map(|one| one.forecast).collect();
    for (free, clear) in [
        (free.forecast_all(&windows).unwrap(), clear),
        (
            free.forecast_central(&windows).unwrap(),
            careful.forecast_central(&windows).unwrap(),
        ),
    ] {
        let [before, after] = [&free, &clear].map(|forecasts| near_pairs(&windows, forecasts, 0.5));
        assert!(after < before, "{before} pairs came near, now {after}");
        // Goals and weights are the same as without avoidance.
        for (free, clear) in free.iter().zip(&clear) {
            for i in 0..free.pedestrians() {
                for k in 0..free.hypotheses() {
                    assert_eq!(free.goal(i, k), clear.goal(i, k));
                    assert!((free.weight(i, k) - clear.weight(i, k)).abs() < 1e-15);
                    assert_eq!(clear.certified(i, k), Some(true));
                }
            }
        }
    }
}

#[test]
fn the_program_keeps_clear_and_reports_it() {
    let place = Place::with_model();
    let forecast = |options: &str| {
        place.ok(&format!(
            "forecast --model run tracks.csv --whole --certificate {options}"
        ))
    };
    let (free, clear) = (forecast(""), forecast("--keep-clear 0.8"));
    assert_eq!(free.lines().count(), clear.lines().count());
    assert_ne!(free, clear);
    assert!(clear.lines().skip(1).all(|row| row.ends_with(",true")));

    let evaluate = "evaluate --model run --threads 1 --test-pedestrians 40 --protocol fair";
    let report = |options: &str| {
        let _ = place.ok(&format!("{evaluate} {options}"));
        Report::load(&place.at("run/report.json")).unwrap()
    };
    let careful = report("--keep-clear 0.4");
    let name = "DDL minding others within 0.4 m";
    let mut rows = careful.rows().iter();
    let row = rows.find(|row| row.conditions.forecaster == name).unwrap();
    assert_eq!(row.scores.stability.unwrap().certified, Some(1.0));
    // Without the option it is another evaluation, so the existing one is not reused.
    let free = report("");
    let mut names = free.rows().iter().map(|row| &row.conditions.forecaster);
    assert!(!names.any(|name| name.contains("minding")));
    place.all_refused(&[
        "forecast tracks.csv --keep-clear=0 => is out of range",
        "forecast tracks.csv --keep-clear=-1 => is out of range",
        "forecast tracks.csv --keep-clear=inf => is out of range",
        "forecast tracks.csv --keep-clear=wide => must be a number",
    ]);
}

#[test]
fn models_without_a_flow_are_refused() {
    for variant in [Variant::Star, Variant::NoDynamics] {
        let place = Place::with_variant(variant);
        let name = format!("`{variant}`");
        let forecast = "forecast --model run tracks.csv";
        place.fails(&format!("{forecast} --certificate"), &[&name, "no flow to certify"]);
        place.fails(&format!("{forecast} --keep-clear 0.4"), &[&name, "has no flow"]);
        let model = drawn_model::of(variant);
        let no_flow = |error: ForecastError| {
            let ForecastError::Model { source, .. } = error else {
                panic!("{error}")
            };
            let expected = CertificateError::NoFlow { variant };
            assert_eq!(source.downcast_ref::<CertificateError>(), Some(&expected));
        };
        no_flow(model.forecast_certified(&crowd::windows(1, 2)).unwrap_err());
        let mut live = LiveForecaster::new(&model);
        match live.push_certified(0, [(PedestrianId(1), [0.0, 0.0])]) {
            Err(DdlError::Forecast(error)) => no_flow(error),
            other => panic!("{other:?}"),
        }
        assert_eq!(live.tracks().last_frame(), None);
        let error = model.with_clearance(Clearance::new(0.4).unwrap()).unwrap_err();
        assert!(matches!(error, DdlError::NoFlow { variant: of } if of == variant));
    }
}
