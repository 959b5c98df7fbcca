//! `--keep-clear`: walkers mind each other, and every certificate still holds.

use ddl::data::Window;
use ddl::eval::metric::collision::closest_approach;
use ddl::report::Report;
use ddl::{Clearance, DdlError, Forecast, Forecaster as _, Variant};
use ddl_tests::own_tracks;
use ddl_tests::{bits, crowd, program, tiny_model};

/// Pairs of walkers in one window whose most likely forecasts come nearer than `distance`.
fn near_pairs(windows: &[Window], forecasts: &[Forecast], distance: f64) -> usize {
    let likeliest =
        |forecast: &Forecast, i| forecast.hypothesis(i, forecast.most_likely(i)).to_vec();
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

#[test]
fn fewer_come_near_and_all_still_arrive() {
    let windows = crowd::windows(12, 12);
    let alone = tiny_model::of(Variant::Full).model;
    let free = alone.forecast_all(&windows).unwrap();
    let careful = alone.keeping_clear(Clearance::new(0.5).unwrap()).unwrap();
    let certified = careful.forecast_certified(&windows).unwrap();
    assert!(certified.iter().all(|one| one.first_violation().is_none()));
    let clear: Vec<Forecast> = certified.iter().map(|one| one.forecast.clone()).collect();
    let (before, after) = (
        near_pairs(&windows, &free, 0.5),
        near_pairs(&windows, &clear, 0.5),
    );
    assert!(before > 0, "a crowd in which nobody meets shows nothing");
    assert!(after < before, "{before} pairs came near, now {after}");
    // Goals and weights are those of walkers alone.
    for (free, clear) in free.iter().zip(&clear) {
        for i in 0..free.pedestrians() {
            for k in 0..free.hypotheses() {
                assert_eq!(free.goal(i, k), clear.goal(i, k));
                assert!((free.weight(i, k) - clear.weight(i, k)).abs() < 1e-15);
            }
        }
    }
}

/// The one forecast minds the others too, on its straight way: some go another way, all still to their goals.
#[test]
fn the_one_forecast_keeps_clear() {
    let windows = crowd::windows(12, 12);
    let alone = tiny_model::of(Variant::Full).model;
    let free = alone.forecast_one(&windows).unwrap();
    let careful = alone.keeping_clear(Clearance::new(0.5).unwrap()).unwrap();
    let clear = careful.forecast_one(&windows).unwrap();
    let (before, after) = (
        near_pairs(&windows, &free, 0.5),
        near_pairs(&windows, &clear, 0.5),
    );
    assert!(after < before, "{before} pairs came near, now {after}");
    for (free, clear) in free.iter().zip(&clear) {
        for i in 0..free.pedestrians() {
            assert_eq!(free.goal(i, 0), clear.goal(i, 0));
            assert_eq!(clear.certified(i, 0), Some(true));
        }
    }
}

/// Somebody alone in the window walks as before, to the last bit.
#[test]
fn nobody_near_changes_nothing() {
    let alone_in = |window: &Window| {
        let track = window.track(0).to_vec();
        let id = vec![window.pedestrians()[0]];
        Window::new(
            window.recording(),
            window.start_frame(),
            window.frame_step(),
            id,
            vec![track],
        )
    };
    let windows: Vec<Window> = crowd::windows(6, 12)
        .iter()
        .map(|window| alone_in(window).unwrap())
        .collect();
    let alone = tiny_model::of(Variant::Full).model;
    let free = alone.forecast_all(&windows).unwrap();
    let careful = alone.keeping_clear(Clearance::new(0.5).unwrap()).unwrap();
    let clear = careful.forecast_all(&windows).unwrap();
    for (free, clear) in free.iter().zip(&clear) {
        assert_eq!(bits::of(free), bits::of(clear));
    }
}

#[test]
fn the_program_keeps_clear_and_says_so() {
    let folder = tiny_model::folder(Variant::Full);
    let rows = own_tracks::three_people(9);
    let forecast = |options: &str| {
        let options = format!("--certificate {options}");
        program::forecast(folder.path(), &rows, &options).succeeds()
    };
    let (free, clear) = (forecast(""), forecast("--keep-clear 0.8"));
    assert_eq!(free.lines().count(), clear.lines().count());
    assert_ne!(free, clear);
    assert!(clear.lines().skip(1).all(|row| row.ends_with(",true")));

    let evaluate = "evaluate --model . --threads 1 --test-walkers 40 --protocol fair";
    let _ = program::run(folder.path(), &format!("{evaluate} --keep-clear 0.4")).succeeds();
    let report = Report::load(&folder.path().join("report.json")).unwrap();
    let row = report
        .rows()
        .iter()
        .find(|row| row.conditions.forecaster == "DDL minding others within 0.4 m")
        .unwrap();
    let certified = row.scores.stability.unwrap().certified.unwrap();
    assert!((certified - 1.0).abs() < 1e-15);
    // Without the option it is another evaluation, not the one that is there.
    let _ = program::run(folder.path(), evaluate).succeeds();
    let report = Report::load(&folder.path().join("report.json")).unwrap();
    let names = |row: &ddl::eval::ResultRow| row.conditions.forecaster.contains("minding");
    assert!(!report.rows().iter().any(names));
}

#[test]
fn what_cannot_keep_clear_is_refused() {
    let folder = tiny_model::folder(Variant::Star);
    let rows = own_tracks::three_people(8);
    let run = |distance: &str| {
        let options = format!("--keep-clear={distance}");
        program::forecast(folder.path(), &rows, &options)
    };
    assert!(run("0.4").fails().contains("`star` has no flow"));
    for (distance, problem) in [
        ("0", "is not allowed"),
        ("-1", "is not allowed"),
        ("inf", "is not allowed"),
        ("wide", "must be a number"),
    ] {
        let finished = run(distance);
        assert_eq!(finished.code, Some(2));
        assert!(finished.stderr.contains(problem), "{finished:?}");
    }
    let error = tiny_model::of(Variant::NoDynamics)
        .model
        .keeping_clear(Clearance::new(0.4).unwrap())
        .unwrap_err();
    let variant = Variant::NoDynamics;
    assert!(matches!(error, DdlError::NoFlow { variant: of } if of == variant));
}
