//! Reading, matching with windows, and scoring.

use std::fmt::Write as _;

use ddl_core::{Forecast, Forecaster as _, PedestrianId, Window, average_displacement};
use ddl_data::{Format, WindowRule, parse_recording};
use ddl_eval::baseline::SocialForce;
use ddl_eval::external::{self, Coverage, ExternalError, ExternalFormat};
use ddl_eval::{Conditions, Protocol, Scores};

use super::files::{
    HEADER, complaint, conditions, expected, hypothesis, line, matched_of, read, rows, still, table, whole_file,
    windows,
};

#[test]
fn every_format_says_the_same() {
    for (text, format) in [
        (whole_file(), ExternalFormat::JsonLines),
        (format!("\u{feff}\n{}", whole_file().replace('\n', "\r\n")), ExternalFormat::JsonLines),
        (table(), ExternalFormat::Table),
        (table().replace('\n', "\r"), ExternalFormat::Table),
        (table().replace("yard,", "\"yard\" ,").replace(",3,0,", ",3.0, 0 ,"), ExternalFormat::Table),
    ] {
        let matched = read(&text, format, Coverage::Whole).unwrap();
        assert_eq!(matched.forecasts, expected(), "{format:?}");
        assert_eq!(matched.windows, windows());
        assert_eq!(matched.pedestrians(), 3);
        assert_eq!(matched.test_subset(), None);
    }
}

#[test]
fn pedestrians_may_have_words_for_names() {
    let words = ["7f3e-aa41", "007"];
    let mut seen = "frame,pedestrian,x,y\n".to_owned();
    for t in 0..20 {
        for (y, word) in words.iter().enumerate() {
            writeln!(seen, "{},{word},{t},{y}", 10 * t).unwrap();
        }
    }
    let windows = parse_recording(seen.as_bytes(), "yard", Format::Table).unwrap().windows(WindowRule::Complete);
    let mut asked = Vec::new();
    external::write_windows(&windows, &mut asked).unwrap();
    let asked = String::from_utf8(asked).unwrap();
    assert!(asked.contains("\"pedestrian\":\"007\""), "{asked}");

    let (mut lines, mut table) = (String::new(), HEADER.to_owned());
    for word in words {
        let quoted = format!("\"{word}\"");
        lines += &line(70, 1, &hypothesis(1.0)).replace(":1,\"hyp", &format!(":{quoted},\"hyp"));
        table += &rows("yard", 70, 4, 0, 1.0, 1.0).replace(",70,4,", &format!(",70,{word},"));
    }
    for (text, format) in [(lines, ExternalFormat::JsonLines), (table, ExternalFormat::Table)] {
        let matched = external::read_from(text.as_bytes(), "f", format, &windows, Coverage::Whole);
        let both = [still(1.0, 0.0), still(1.0, 0.0)].concat();
        let both = Forecast::with_equal_weights(2, 1, both).unwrap();
        assert_eq!(matched.unwrap().forecasts, [both], "{format:?}");
    }
    let one = line(70, 1, &hypothesis(1.0)).replace(":1,\"hyp", ":\"007\",\"hyp");
    let message = matched_of(&windows, &one, Coverage::Whole).unwrap_err().to_string();
    assert!(message.contains("observed until 70 pedestrian 7f3e-aa41"));
}

#[test]
fn what_ddl_forecast_writes_beside_is_passed_over_and_goals_of_null_are_none() {
    let frames: Vec<i64> = (8..20).map(|t| 10 * t).collect();
    let first = format!(
        "{{\"observed_until\":70,\"pedestrian\":3,\"frames\":{frames:?},\"hypotheses\":\
         [{{\"weight\":0.75,\"goal\":[1.0,0.0],\"positions\":{p:?},\
         \"certificate\":{{\"holds\":true,\"violation\":null}}}},\
         {{\"weight\":0.25,\"goal\":[2.0,0.0],\"positions\":{p:?}}}]}}\n",
        p = still(1.0, 0.0)
    );
    let matched = read(&first, ExternalFormat::JsonLines, Coverage::Intersection).unwrap();
    let forecast = &matched.forecasts[0];
    assert_eq!(forecast.goal(0, 1), Some([2.0, 0.0]));
    assert!((forecast.weight(0, 0) - 0.75).abs() < f64::EPSILON);
    let text = whole_file().replace("{\"positions\"", "{\"goal\":null,\"weight\":1.0,\"positions\"");
    assert_eq!(read(&text, ExternalFormat::JsonLines, Coverage::Whole).unwrap().forecasts, expected());
}

#[test]
fn the_intersection_is_named_beside_the_callers_subset_and_scored_alone() {
    let subset = |text: &str, coverage, named: Option<&str>| {
        let matched = read(text, ExternalFormat::JsonLines, coverage).unwrap();
        let conditions = Conditions { test_subset: named.map(str::to_owned), ..conditions(Protocol::Fair) };
        let rows = external::measure(&conditions, &matched).unwrap();
        assert_eq!(rows[0].conditions.forecaster, "mine");
        let of_all = rows[1].conditions.test_subset.clone();
        assert_eq!(rows[0].conditions.test_subset, of_all);
        (matched, rows, of_all.unwrap())
    };
    let two = line(70, 5, &hypothesis(2.0)) + &line(70, 4, &hypothesis(9.0));
    // The digests are of "yard", 70 and the pedestrian, computed with Python's hashlib.
    let (matched, rows, named) = subset(&two, Coverage::Intersection, None);
    assert_eq!(named, "pedestrians forecast by another program: 1 of 3, digest f5c3a037");
    let windows = &matched.windows;
    assert_eq!(windows.len(), 1);
    assert_eq!(windows[0].pedestrians(), [PedestrianId(5)]);
    assert!(rows.iter().all(|row| row.scores.pedestrians == 1));
    let scores = Scores::evaluate(windows, &matched.forecasts).unwrap();
    assert_eq!(rows[0].scores, scores);
    // The pedestrian walks from x = 4 to 9.5 at y = 2, and is forecast at (2, 0).
    assert!((scores.min_fde - f64::hypot(7.5, 2.0)).abs() < 1e-12);
    let every = "every second window";
    let other = line(70, 3, &hypothesis(2.0));
    let (.., named) = subset(&other, Coverage::Intersection, Some(every));
    let part = "pedestrians forecast by another program: 1 of 3, digest 0f80b53d";
    assert_eq!(named, format!("{every}; {part}"));
    assert_eq!(subset(&whole_file(), Coverage::Whole, Some(every)).2, every);
}

#[test]
fn hypotheses_of_a_table_are_ordered_by_their_numbers() {
    for first in [0, 1] {
        let (second, last) = (first + 1, rows("yard", 80, 5, first, 0.25, 5.0));
        let text = HEADER.to_owned()
            + &rows("yard", 70, 3, first, 0.75, 1.0)
            + &rows("yard", 70, 3, second, 0.25, 2.0)
            + &rows("yard", 70, 5, second, 0.625, 4.0)
            + &rows("yard", 70, 5, first, 0.375, 3.0)
            + &last
            + &rows("yard", 80, 5, second, 0.75, 6.0);
        let matched = read(&text, ExternalFormat::Table, Coverage::Whole).unwrap();
        let forecast = &matched.forecasts[0];
        for (i, k, x) in [(0, 0, 1.0), (0, 1, 2.0), (1, 0, 3.0), (1, 1, 4.0)] {
            assert_eq!(forecast.hypothesis(i, k), still(x, 0.0), "{i} {k}");
        }
        assert!((forecast.weight(1, 0) - 0.375).abs() < f64::EPSILON);
    }
}

#[test]
fn extensions_name_the_format_in_capitals_too() {
    for (name, format) in [
        ("a.csv", ExternalFormat::Table),
        ("a.CSV", ExternalFormat::Table),
        ("a.JSONL", ExternalFormat::JsonLines),
        ("a", ExternalFormat::JsonLines),
    ] {
        assert_eq!(ExternalFormat::of_file(name.as_ref()), format, "{name}");
    }
}

/// 1 walks east and meets 2, which walks west and has no forecast; 3 is far away. The social force model avoids 2.
#[test]
fn baselines_see_whom_nobody_forecast() {
    let track = |path: fn(f64) -> [f64; 2]| (0..20).map(|t| path(f64::from(t))).collect::<Vec<_>>();
    let tracks = vec![
        track(|t| [0.5 * t, -0.5 * (t - 15.0).max(0.0)]),
        track(|t| [15.0 - 0.5 * t, 0.125]),
        track(|t| [0.5 * t, 50.0]),
    ];
    let ids = vec![PedestrianId(1), PedestrianId(2), PedestrianId(3)];
    let windows = [Window::new("yard", 0, 10, ids, tracks).unwrap()];
    let straight_on = |y: f64| {
        let positions: Vec<_> = (8..20).map(|t| [0.5 * f64::from(t), y]).collect();
        format!("{{\"positions\":{positions:?}}}")
    };
    let text = line(70, 1, &straight_on(0.0)) + &line(70, 3, &straight_on(50.0));
    let matched = matched_of(&windows, &text, Coverage::Intersection).unwrap();
    let rows = external::measure(&conditions(Protocol::Single), &matched).unwrap();
    // 2 has no forecast.
    assert!(rows[0].scores.collision_rate.abs() < f64::EPSILON);
    let mut forces = rows.iter();
    let forces = forces.find(|row| row.conditions.forecaster == "social force");
    let forced = SocialForce.forecast(&windows[0]).unwrap();
    let ade = |i: usize| average_displacement(forced.hypothesis(i, 0), windows[0].future(i));
    assert!(ade(0) > 0.01, "{}", ade(0));
    let expected = f64::midpoint(ade(0), ade(2));
    assert!((forces.unwrap().scores.min_ade - expected).abs() < 1e-12);
}

#[test]
fn the_protocol_published_is_refused_with_the_reason() {
    let matched = read(&whole_file(), ExternalFormat::JsonLines, Coverage::Whole).unwrap();
    let error = external::measure(&conditions(Protocol::Published), &matched).unwrap_err();
    assert!(matches!(error, ExternalError::Published));
    assert!(error.to_string().contains("the forecaster chooses the goal"));
}

#[test]
fn missing_forecasts_and_forecasts_without_a_pedestrian_are_counted_and_named() {
    let mine = complaint(&line(70, 5, &hypothesis(2.0)), ExternalFormat::JsonLines);
    assert_eq!(
        mine,
        "f forecasts 1 of the 3 pedestrians in the windows; 2 are missing, the first of them `yard` observed until 70 \
         pedestrian 3, `yard` observed until 80 pedestrian 5; forecast them too, or score the intersection only"
    );
    let hint = |text: &str| complaint(&(whole_file() + text), ExternalFormat::JsonLines);
    let elsewhere = line(70, 5, &hypothesis(2.0)).replace("{\"obs", "{\"recording\":\"eth\",\"obs");
    assert_eq!(
        hint(&elsewhere),
        "f: 1 of 4 forecasts match no pedestrian of the windows, the first one `eth` observed until 70 pedestrian 5; \
         the \
         windows are of yard, the file also of eth; is it of another fold?"
    );
    for (until, pedestrian, expected) in [
        (10, 5, "if observed_until were the first frame of a window"),
        (90, 5, "if observed_until were the first frame forecast"),
        (700, 5, "their frames run from 700 to 700, those of the windows from 70 to 80"),
        (70, 6, "another fold, data convention or window rule?"),
    ] {
        let text = line(until, pedestrian, &hypothesis(2.0));
        let alone = complaint(&text, ExternalFormat::JsonLines);
        assert!(alone.contains(expected), "{alone}");
    }
    // If the other forecasts match, one that would match after a shift is no evidence against the frame.
    let among_others = hint(&line(90, 5, &hypothesis(2.0)));
    assert!(!among_others.contains("first frame forecast"));
    let nothing = read(&line(9, 9, &hypothesis(0.0)), ExternalFormat::JsonLines, Coverage::Intersection);
    assert!(matches!(nothing, Err(ExternalError::Unknown { .. })));
}

#[test]
fn the_recording_may_be_left_out_only_where_there_is_one() {
    let mut two = windows();
    let walk = vec![(0..20).map(|t| [f64::from(t), 9.0]).collect()];
    two.push(Window::new("square", 0, 10, vec![PedestrianId(3)], walk).unwrap());
    let text = whole_file();
    let read = |text: &str| matched_of(&two, text, Coverage::Whole);
    assert_eq!(
        read(&text).unwrap_err().to_string(),
        "f, line 1, recording: is missing, but the windows have several recordings: yard, square"
    );
    let named = |text: &str, name: &str| text.replace("{\"obs", &format!("{{\"recording\":\"{name}\",\"obs"));
    let both = named(&text, "yard") + &named(&line(70, 3, &hypothesis(4.0)), "square");
    let matched = read(&both).unwrap();
    assert_eq!(matched.forecasts.len(), 3);
    assert_eq!(matched.forecasts[2].hypothesis(0, 0), still(4.0, 0.0));
}

/// If half of the forecasts start away from their pedestrians, the error names the usual reasons, and nothing is
/// scored.
#[test]
fn forecasts_that_begin_elsewhere_are_refused_with_a_likely_reason() {
    let hypothesis = |[x, y]: [f64; 2]| format!("{{\"positions\":{:?}}}", still(x, y));
    let file = |first, second, third| {
        line(70, 3, &hypothesis(first)) + &line(70, 5, &hypothesis(second)) + &line(80, 5, &hypothesis(third))
    };
    // The pedestrians were last seen at (3.5, 0), (3.5, 2) and (3.5, 2.5).
    let swapped = file([0.2, 9.5], [2.0, 9.5], [2.5, 9.5]);
    let mut far = windows();
    for window in &mut far {
        *window = window.map_positions(|_, _, [x, y]| [x + 6.0, y]);
    }
    let measure = |text: &str| {
        let matched = matched_of(&far, text, Coverage::Intersection).unwrap();
        external::measure(&conditions(Protocol::Fair), &matched)
    };
    for (text, expected) in [
        (swapped, "if x and y were exchanged"),
        (file([0.4, 0.0], [0.5, 0.1], [0.3, 0.0]), "relative to the last observed position"),
        (file([90.0, 0.0], [91.0, 0.0], [92.0, 0.0]), "in metres, and of the same data convention"),
    ] {
        let complaint = measure(&text).unwrap_err().to_string();
        assert!(complaint.contains(expected), "{complaint}");
        assert!(complaint.starts_with("f: half of the forecasts start "));
    }
    // One of three is far off, or all by 4 m; or only the less likely hypotheses, which come first.
    assert!(measure(&file([9.9, 0.0], [9.8, 2.0], [90.0, 2.5])).is_ok());
    assert!(measure(&file([13.6, 0.0], [13.6, 2.0], [13.6, 2.5])).is_err());
    let both = |y: f64| {
        let [far, near] = [[90.0, y], [9.5, y]].map(|at| hypothesis(at).replacen('{', "{\"weight\":W,", 1));
        far.replace('W', "0.25") + "," + &near.replace('W', "0.75")
    };
    let weighted = line(70, 3, &both(0.0)) + &line(70, 5, &both(2.0)) + &line(80, 5, &both(2.5));
    assert!(measure(&weighted).is_ok());
}
