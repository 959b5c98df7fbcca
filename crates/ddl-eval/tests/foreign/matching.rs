//! What is read, matched with windows, and scored.

use ddl_data::{Convention, PedestrianId, Window, WindowRule};
use ddl_eval::foreign::{self, Coverage, ForeignError, ForeignFormat};
use ddl_eval::{Conditions, Protocol, Scores, baseline};

use crate::files::{
    complaint, expected, hypothesis, line, ndjson, read, scene, still, table, tracks, whole,
    windows,
};

#[test]
fn every_format_says_the_same() {
    for (text, format) in [
        (whole(), ForeignFormat::JsonLines),
        (
            format!("\u{feff}\n{}", whole().replace('\n', "\r\n")),
            ForeignFormat::JsonLines,
        ),
        (table(), ForeignFormat::Table),
        (
            table()
                .replace("yard,", "\"yard\" ,")
                .replace(",3,0,", ",3.0, 0 ,"),
            ForeignFormat::Table,
        ),
        (ndjson(), ForeignFormat::TrajNet),
    ] {
        let matched = read(&text, format, Coverage::Whole).unwrap();
        assert_eq!(matched.forecasts, expected(), "{format}");
        assert_eq!(matched.windows, windows());
        assert_eq!((matched.forecast_walkers(), matched.walkers()), (3, 3));
        assert_eq!(matched.test_subset(), None);
    }
}

#[test]
fn a_neighbour_counts_where_no_scene_has_it_as_its_own() {
    let text = scene(0, 3, 0)
        + &tracks(0, 3, 0, 70, 1.0)
        + &tracks(0, 5, 0, 70, 2.0)
        + &scene(2, 5, 10)
        + &tracks(2, 5, 0, 80, 3.0);
    let matched = read(&text, ForeignFormat::TrajNet, Coverage::Whole).unwrap();
    assert_eq!(matched.forecasts, expected());
}

#[test]
fn the_output_of_ddl_forecast_is_read_as_it_is() {
    let frames: Vec<i64> = (8..20).map(|t| 10 * t).collect();
    let first = format!(
        "{{\"observed_until\":70,\"pedestrian\":3,\"frames\":{frames:?},\"hypotheses\":[{{\"weight\":0.75,\"goal\":[1.0,0.0],\
         \"positions\":{p:?},\"certificate\":{{\"holds\":true,\"violation\":null}}}},{{\"weight\":0.25,\"goal\":[2.0,0.0],\"positions\":{p:?}}}]}}\n",
        p = still(1.0, 0.0)
    );
    let matched = read(&first, ForeignFormat::JsonLines, Coverage::Intersection).unwrap();
    let forecast = &matched.forecasts[0];
    assert_eq!((forecast.pedestrians(), forecast.hypotheses()), (1, 2));
    assert_eq!(forecast.goal(0, 1), Some([2.0, 0.0]));
    assert!((forecast.weight(0, 0) - 0.75).abs() < f64::EPSILON);
    // goals that are null are none
    let text = whole().replace(
        "{\"positions\"",
        "{\"goal\":null,\"weight\":1.0,\"positions\"",
    );
    let matched = read(&text, ForeignFormat::JsonLines, Coverage::Whole).unwrap();
    assert_eq!(matched.forecasts, expected());
}

#[test]
fn the_intersection_names_itself_and_scores_those_alone() {
    let text = line(70, 5, &hypothesis(2.0)) + &line(70, 4, &hypothesis(9.0));
    let matched = read(&text, ForeignFormat::JsonLines, Coverage::Intersection).unwrap();
    assert_eq!(
        matched.test_subset().unwrap(),
        "walkers forecast by f: 1 of 3"
    );
    assert_eq!(matched.windows.len(), 1);
    assert_eq!(matched.windows[0].pedestrians(), [PedestrianId(5)]);
    let conditions = Conditions::new(
        Convention::Star,
        WindowRule::Complete,
        Protocol::Fair,
        "yard",
        "mine",
    );
    let rows = foreign::measure(&conditions, &matched, baseline::NOISE_SEED).unwrap();
    for row in &rows {
        assert_eq!(row.scores.pedestrians, 1);
        assert_eq!(row.conditions.test_subset, matched.test_subset());
    }
    assert_eq!(rows[0].conditions.forecaster, "mine");
    assert_eq!(
        rows[0].scores,
        Scores::evaluate(&matched.windows, &matched.forecasts).unwrap()
    );
    // he goes on from x = 4 to 9.5 at y = 2, and is forecast at (2, 0)
    let end = f64::hypot(7.5, 2.0);
    assert!((rows[0].scores.min_fde - end).abs() < 1e-12);
}

#[test]
fn the_protocol_published_is_refused_with_the_reason() {
    let matched = read(&whole(), ForeignFormat::JsonLines, Coverage::Whole).unwrap();
    let conditions = Conditions::new(
        Convention::Star,
        WindowRule::Complete,
        Protocol::Published,
        "yard",
        "mine",
    );
    let error = foreign::measure(&conditions, &matched, 1).unwrap_err();
    assert!(matches!(error, ForeignError::Published));
    assert!(error.to_string().contains("inside the forecaster"));
}

#[test]
fn walkers_that_are_missing_and_forecasts_of_nobody_are_counted_and_named() {
    let mine = complaint(&line(70, 5, &hypothesis(2.0)), ForeignFormat::JsonLines);
    assert_eq!(
        mine,
        "f forecasts 1 of the 3 walkers in the windows; 2 are missing, the first of them `yard` observed until 70 \
         pedestrian 3, `yard` observed until 80 pedestrian 5; forecast them too, or score the intersection alone"
    );
    let hint = |text: &str| complaint(&(whole() + text), ForeignFormat::JsonLines);
    let elsewhere = line(70, 5, &hypothesis(2.0)).replace("{\"obs", "{\"recording\":\"eth\",\"obs");
    assert_eq!(
        hint(&elsewhere),
        "f: 1 of 4 forecasts are of nobody in the windows, the first of `eth` observed until 70 pedestrian 5; the \
         windows are of yard, the file also of eth; is it of another fold?"
    );
    for (text, expected) in [
        (
            line(10, 5, &hypothesis(2.0)),
            "if observed_until were the first frame of a window",
        ),
        (
            line(90, 5, &hypothesis(2.0)),
            "if observed_until were the first frame forecast",
        ),
        (
            line(700, 5, &hypothesis(2.0)),
            "their frames run from 700 to 700, those of the windows from 70 to 80",
        ),
        (
            line(70, 6, &hypothesis(2.0)),
            "another fold, data convention or window rule?",
        ),
    ] {
        assert!(hint(&text).contains(expected), "{}", hint(&text));
    }
    let nothing = read(
        &line(9, 9, &hypothesis(0.0)),
        ForeignFormat::JsonLines,
        Coverage::Intersection,
    );
    assert!(matches!(nothing, Err(ForeignError::Unknown { .. })));
}

#[test]
fn the_recording_may_be_left_out_only_where_there_is_one() {
    let mut two = windows();
    let walk = vec![(0..20).map(|t| [f64::from(t), 9.0]).collect()];
    two.push(Window::new("square", 0, 10, vec![PedestrianId(3)], walk).unwrap());
    let text = whole();
    let read = |text: &str| {
        foreign::read_from(
            text.as_bytes(),
            "f",
            ForeignFormat::JsonLines,
            &two,
            Coverage::Whole,
        )
    };
    assert_eq!(
        read(&text).unwrap_err().to_string(),
        "f, line 1, recording: is missing, and the windows are of several recordings: yard, square"
    );
    let of = |text: &str, name: &str| {
        text.replace("{\"obs", &format!("{{\"recording\":\"{name}\",\"obs"))
    };
    let both = of(&text, "yard") + &of(&line(70, 3, &hypothesis(4.0)), "square");
    let matched = read(&both).unwrap();
    assert_eq!(matched.forecasts.len(), 3);
    assert_eq!(matched.forecasts[2].hypothesis(0, 0), still(4.0, 0.0));
}
