//! Forecasts of another program: every format reads the same, and every mistake is named with its place.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

use std::fmt::Write as _;

use ddl_data::{Convention, HORIZON, PedestrianId, Position, Window, WindowRule};
use ddl_eval::foreign::{self, Coverage, ForeignError, ForeignFormat, Matched};
use ddl_eval::{Conditions, Forecast, Protocol, Scores};

/// Two windows of the recording `yard`, observed until 70 and until 80: pedestrians 3 and 5, then 5.
fn windows() -> Vec<Window> {
    let walk = |y: f64| (0..20).map(|t| [0.5 * f64::from(t), y]).collect::<Vec<_>>();
    let ids = |ids: &[i64]| ids.iter().map(|&id| PedestrianId(id)).collect();
    vec![
        Window::new("yard", 0, 10, ids(&[3, 5]), vec![walk(0.0), walk(2.0)]).unwrap(),
        Window::new("yard", 10, 10, ids(&[5]), vec![walk(2.5)]).unwrap(),
    ]
}

/// A forecast that stands still at (x, y).
fn still(x: f64, y: f64) -> Vec<Position> {
    vec![[x, y]; HORIZON]
}

fn line(observed_until: i64, pedestrian: i64, hypotheses: &str) -> String {
    format!(
        "{{\"observed_until\":{observed_until},\"pedestrian\":{pedestrian},\"hypotheses\":[{hypotheses}]}}\n"
    )
}

fn hypothesis(x: f64) -> String {
    format!("{{\"positions\":{:?}}}", still(x, 0.0))
}

/// All three walkers with one hypothesis each, at x = 1, 2 and 3.
fn whole() -> String {
    line(70, 3, &hypothesis(1.0)) + &line(70, 5, &hypothesis(2.0)) + &line(80, 5, &hypothesis(3.0))
}

fn read(text: &str, format: ForeignFormat, coverage: Coverage) -> Result<Matched, ForeignError> {
    foreign::read_from(text.as_bytes(), "f", format, &windows(), coverage)
}

fn complaint(text: &str, format: ForeignFormat) -> String {
    read(text, format, Coverage::Whole).unwrap_err().to_string()
}

fn expected() -> Vec<Forecast> {
    let one = |at: &[f64]| {
        let positions = at.iter().flat_map(|&x| still(x, 0.0)).collect();
        Forecast::equally_likely(at.len(), 1, positions).unwrap()
    };
    vec![one(&[1.0, 2.0]), one(&[3.0])]
}

/// The rows of a table: a walker and where it stands.
fn rows(
    recording: &str,
    until: i64,
    pedestrian: i64,
    hypothesis: i64,
    weight: f64,
    x: f64,
) -> String {
    (1..=12).fold(String::new(), |mut text, t| {
        let frame = until + 10 * t;
        writeln!(
            text,
            "{recording},{until},{pedestrian},{hypothesis},{weight},{frame},{x},0,ok"
        )
        .unwrap();
        text
    })
}

const HEADER: &str = "recording,observed_until,pedestrian,hypothesis,weight,frame,x,y,certified\n";

fn table() -> String {
    HEADER.to_owned()
        + &rows("yard", 70, 3, 0, 1.0, 1.0)
        + &rows("yard", 70, 5, 0, 1.0, 2.0)
        + &rows("yard", 80, 5, 0, 1.0, 3.0)
}

fn scene(id: i64, primary: i64, start: i64) -> String {
    let end = start + 190;
    format!(
        "{{\"scene\": {{\"id\": {id}, \"p\": {primary}, \"s\": {start}, \"e\": {end}, \"fps\": 2.5, \"tag\": 0}}}}\n"
    )
}

fn tracks(scene: i64, pedestrian: i64, prediction: i64, until: i64, x: f64) -> String {
    (1..=12).fold(String::new(), |mut text, t| {
        let f = until + 10 * t;
        writeln!(text, "{{\"track\": {{\"f\": {f}, \"p\": {pedestrian}, \"x\": {x:?}, \"y\": 0.0, \"prediction_number\": {prediction}, \"scene_id\": {scene}}}}}").unwrap();
        text
    })
}

/// Scene 0 forecasts 3 and its neighbours 5 and 9, who is in no window; scene 1 forecasts 5 for its own sake.
fn ndjson() -> String {
    scene(0, 3, 0)
        + "{\"track\": {\"f\": 0, \"p\": 3, \"x\": 0.0, \"y\": 0.0}}\n"
        + &tracks(0, 3, 0, 70, 1.0)
        + &tracks(0, 5, 0, 70, 8.0)
        + &tracks(0, 9, 0, 70, 9.0)
        + &scene(1, 5, 0)
        + &scene(2, 5, 10)
        + &tracks(1, 5, 0, 70, 2.0)
        + &tracks(2, 5, 0, 80, 3.0)
}

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
    let rows = foreign::measure(&conditions, &matched, foreign::NOISE_SEED).unwrap();
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

fn check(format: ForeignFormat, text: &str, expected: &str) {
    let complaint = complaint(text, format);
    assert!(
        complaint.starts_with(expected),
        "{text}\n{complaint}\n{expected}"
    );
}

#[test]
fn every_mistake_of_json_lines_is_named_with_its_place() {
    let first = line(70, 3, &hypothesis(1.0));
    let bad = |text: &str| first.clone() + text;
    let eleven = hypothesis(2.0).replacen("[2.0, 0.0], ", "", 1);
    let spoiled = |word: &str| {
        let positions = format!("{{\"positions\":{:?}}}", still(2.0, 0.0));
        line(
            70,
            5,
            &positions.replacen("2.0, 0.0], [2.0", &format!("2.0, 0.0], [{word}"), 1),
        )
    };
    let not_finite = "f, line 2, hypotheses[0].positions[1][0]: must be a finite number, found null, NaN or infinity";
    let twice = hypothesis(1.0) + "," + &hypothesis(2.0);
    let weighted = |a: &str, b: &str| {
        let with = |w: &str| hypothesis(1.0).replacen('{', &format!("{{{w}"), 1);
        line(70, 5, &(with(a) + "," + &with(b)))
    };
    let cases = [
        (String::new(), "f, line 1: the file holds no forecast"),
        (bad("[1]"), "f, line 2: not a JSON object"),
        (
            bad("{\"observed_until\":70,"),
            "f, line 2: not a JSON object",
        ),
        (
            bad("{\"pedestrian\":5,\"hypotheses\":[]}"),
            "f, line 2, observed_until: is missing",
        ),
        (
            bad("{\"observed_until\":70,\"hypotheses\":[]}"),
            "f, line 2, pedestrian: is missing",
        ),
        (
            bad("{\"observed_until\":70,\"pedestrian\":5}"),
            "f, line 2, hypotheses: is missing",
        ),
        (bad(&line(70, 5, "")), "f, line 2: at least one hypothesis"),
        (
            bad(&line(70, 5, "7")),
            "f, line 2, hypotheses[0]: must be an object, found 7",
        ),
        (
            bad(&line(70, 5, "{}")),
            "f, line 2, hypotheses[0].positions: is missing",
        ),
        (
            bad("{\"observed_until\":70.5,\"pedestrian\":5,\"hypotheses\":[]}"),
            "f, line 2, observed_until: must be a whole number, found 70.5",
        ),
        (
            bad("{\"recording\":7,\"observed_until\":70,\"pedestrian\":5,\"hypotheses\":[]}"),
            "f, line 2, recording: must be a name in quotes",
        ),
        (
            bad(&line(70, 5, &eleven)),
            "f, line 2, hypotheses[0].positions: 11 positions; a forecast has 12",
        ),
        (bad(&spoiled("NaN")), not_finite),
        (bad(&spoiled("null")), not_finite),
        (bad(&spoiled("-Infinity")), not_finite),
        (
            bad(&spoiled("\"2\"")),
            "f, line 2, hypotheses[0].positions[1][0]: must be a finite number, found \"2\"",
        ),
        (
            bad(&spoiled("1e999")),
            "f, line 2: not a JSON object: number out of range",
        ),
        (
            bad(&spoiled("2.0, 3.0")),
            "f, line 2, hypotheses[0].positions[1]: must be [x, y] in metres, found [2.0,3.0,0.0]",
        ),
        (
            bad(&line(70, 5, &twice)),
            "f, line 2: 2 hypotheses, but 1 on line 1",
        ),
        (
            bad(&first),
            "f, line 2: this walker was forecast on line 1 already",
        ),
        (
            weighted("\"weight\":0.5,", ""),
            "f, line 1, hypotheses: either every hypothesis of a walker has a weight",
        ),
        (
            weighted("\"weight\":0.5,", "\"weight\":NaN,"),
            "f, line 1, hypotheses[1].weight: must be a finite number",
        ),
        (
            weighted("\"weight\":0.5,", "\"weight\":0.6,"),
            "f, line 1, weight: the weights sum to 1.1",
        ),
        (
            weighted("\"weight\":1.5,", "\"weight\":-0.5,"),
            "f, line 1, weight: a weight must not be below 0, found -0.5",
        ),
        (
            weighted("\"goal\":[1,2],", ""),
            "f, line 1, hypotheses[1].goal: is missing",
        ),
        (
            bad(&line(
                70,
                5,
                &hypothesis(1.0).replacen('{', "{\"goal\":[1,2],", 1),
            )),
            "f, line 2: either every hypothesis of the file has a goal",
        ),
        (
            first.replacen('{', "{\"frames\":[71,72,73,74,75,76,77,78,79,80,81,82],", 1),
            "f, line 1, frames: the forecast is of the frames 71, 72 to 82; the 12 after the last observed one are 80, 90 to 190",
        ),
    ];
    for (text, expected) in &cases {
        check(ForeignFormat::JsonLines, text, expected);
    }
}

#[test]
fn every_mistake_of_a_table_is_named_with_its_place() {
    let first = HEADER.to_owned() + &rows("yard", 70, 3, 0, 1.0, 1.0);
    let second = rows("yard", 70, 5, 0, 1.0, 2.0);
    let changed = |from: &str, to: &str| first.clone() + &second.replacen(from, to, 1);
    let cases = [
        (String::new(), "f, line 1: the file holds no forecast"),
        (HEADER.to_owned(), "f, line 1: the file holds no forecast"),
        (
            "observed_until,pedestrian,x,y\n".to_owned(),
            "f, line 1: the header must name",
        ),
        (
            HEADER.replace("certified", "x"),
            "f, line 1: the header must name",
        ),
        (
            changed(",ok", ""),
            "f, line 14: 8 fields where the header names 9",
        ),
        (
            changed(",70,", ",seventy,"),
            "f, line 14, observed_until: must be a whole number, found \"seventy\"",
        ),
        (
            changed(",2,0,ok", ",NaN,0,ok"),
            "f, line 14, x: must be a finite number, found \"NaN\"",
        ),
        (
            changed(",2,0,ok", ",2,inf,ok"),
            "f, line 14, y: must be a finite number, found \"inf\"",
        ),
        (
            changed(",1,80,", ",,80,"),
            "f, line 14, weight: must be a finite number, found \"\"",
        ),
        (
            changed(",1,90,", ",0.5,90,"),
            "f, line 15, weight: weight 0.5, but 1 in the row before",
        ),
        (
            changed(",80,", ",81,"),
            "f, line 14, frames: the forecast is of the frames 81, 90 to 190",
        ),
        (
            changed("yard,70,5,0,1,80,2,0,ok\n", ""),
            "f, line 14: 11 positions; a forecast has 12",
        ),
        (
            first.clone() + &second + &second[..second.find('\n').unwrap()],
            "f, line 26: 13 positions",
        ),
        (
            first.clone() + &second + &rows("yard", 70, 3, 0, 1.0, 1.0),
            "f, line 26: this walker was forecast on line 2 already",
        ),
        (
            first.clone()
                + &rows("yard", 70, 5, 0, 0.5, 1.0)
                + &rows("yard", 70, 5, 1, 0.5, 1.0)
                + &rows("yard", 70, 5, 0, 0.5, 1.0),
            "f, line 38, hypothesis: hypothesis 0 is there already",
        ),
        (
            first.clone() + &rows("yard", 70, 5, 0, 0.5, 1.0),
            "f, line 14, weight: the weights sum to 0.5",
        ),
    ];
    for (text, expected) in &cases {
        check(ForeignFormat::Table, text, expected);
    }
}

#[test]
fn every_mistake_of_trajnet_is_named_with_its_place() {
    let own = tracks(0, 3, 0, 70, 1.0);
    let good = scene(0, 3, 0) + &own;
    let cases = [
        (scene(0, 3, 0), "f, line 1: the file holds no forecast"),
        (
            own.clone(),
            "f, line 1, track.scene_id: scene 0 has no scene line before its tracks",
        ),
        (
            good.clone() + &scene(0, 5, 0),
            "f, line 14, scene.id: scene 0 was finished on an earlier line",
        ),
        (
            good.clone() + &scene(1, 5, 0) + &tracks(1, 5, 0, 70, 1.0) + &own,
            "f, line 27, track.scene_id: scene 0 was finished",
        ),
        (
            good.replacen("\"scene_id\": 0", "\"x2\": 0", 1),
            "f, line 2, track.scene_id: is missing",
        ),
        (
            good.replacen("\"x\": 1.0", "\"x\": NaN", 1),
            "f, line 2, track.x: must be a finite number, found null, NaN",
        ),
        (
            good.replacen("\"f\": 80", "\"f\": 80.5", 1),
            "f, line 2, track.f: must be a whole number",
        ),
        (
            good.replacen("\"f\": 80", "\"f\": 81", 1),
            "f, line 2, prediction_number 0: the forecast is of the frames 81, 90 to 190",
        ),
        (
            good.replacen("\"e\": 190", "\"e\": 200", 1),
            "f, line 2, scene 0: the forecast is of the frames 0 to 200",
        ),
        (
            good.clone() + &own.lines().next().unwrap().replace("190", "200"),
            "f, line 2, prediction_number 0: 13 positions",
        ),
        (
            good.replacen("\"p\": 3,", "", 1),
            "f, line 1, scene.p: is missing",
        ),
        (
            good.replacen("{\"scene\": {", "{\"scene\": [{", 1),
            "f, line 1: not a JSON object",
        ),
        (
            scene(0, 3, 0)
                + &own
                + &tracks(0, 5, 0, 70, 1.0)
                + &scene(1, 3, 10)
                + &tracks(1, 5, 0, 80, 2.0)
                + &scene(2, 4, 0)
                + &tracks(2, 5, 0, 70, 2.0),
            "f, line 40: pedestrian 5 is a neighbour in two scenes that forecast it differently (line 14)",
        ),
    ];
    for (text, expected) in &cases {
        check(ForeignFormat::TrajNet, text, expected);
    }
}

#[test]
fn text_that_is_not_utf8_is_refused_at_its_line() {
    let mut bytes = whole().into_bytes();
    bytes.extend(b"\xff\xfe\n");
    for format in ForeignFormat::ALL {
        let text: &[u8] = if format == ForeignFormat::JsonLines {
            &bytes
        } else {
            b"\n\xff"
        };
        let error = foreign::read_from(text, "f", format, &windows(), Coverage::Whole).unwrap_err();
        let line = if format == ForeignFormat::JsonLines {
            4
        } else {
            2
        };
        assert_eq!(
            error.to_string(),
            format!("f, line {line}: the text is not UTF-8")
        );
    }
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
