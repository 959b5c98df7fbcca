//! Every mistake is named with its place.

use ddl_eval::foreign::{self, Coverage, ForeignFormat};

use crate::files::{
    HEADER, complaint, hypothesis, line, rows, scene, still, tracks, whole, windows,
};

fn check(format: ForeignFormat, text: &str, expected: &str) {
    let complaint = complaint(text, format);
    assert!(
        complaint.starts_with(expected),
        "{text}\n{complaint}\n{expected}"
    );
}

#[test]
#[expect(clippy::too_many_lines, reason = "a table of mistakes")]
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
            weighted("\"weight\":0.5,", "\"weight\":null,"),
            "f, line 1, hypotheses[1].weight: must be a finite number, found null, NaN or infinity",
        ),
        (
            // what programs write for a goal of NaN; a bare null is no goal
            weighted("\"goal\":[null,null],", "\"goal\":[1,2],"),
            "f, line 1, hypotheses[0].goal[0]: must be a finite number",
        ),
        (
            weighted("\"goal\":[1,2],", "\"goal\":null,"),
            "f, line 1, hypotheses[1].goal: is missing",
        ),
        (
            bad(&first.replacen('{', "{\"pedestrian\":5,", 1)),
            "f, line 2, pedestrian: is there twice; keep one",
        ),
        (
            weighted("\"weight\":0.5,", "\"weight\":0.5,\"weight\":0.5,"),
            "f, line 1, hypotheses[1].weight: is there twice",
        ),
        (
            line(70, 5, &vec![hypothesis(1.0); 21].join(",")),
            "f, line 1, hypotheses: more than 20 hypotheses of observed until 70 pedestrian 5; the protocols allow 20",
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
#[expect(clippy::too_many_lines, reason = "a table of mistakes")]
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
        (
            HEADER.to_owned()
                + &rows("yard", 70, 5, 2, 0.5, 1.0)
                + &rows("yard", 70, 5, 0, 0.5, 1.0),
            "f, line 2, hypothesis: the hypotheses of `yard` observed until 70 pedestrian 5 have the numbers 0, 2, \
             expected 0 to 1 or 1 to 2",
        ),
        (
            first.clone() + &rows("yard", 70, 5, 1, 1.0, 1.0),
            "f, line 14, hypothesis: the hypotheses of `yard` observed until 70 pedestrian 5 have the numbers 1, \
             expected 0 as before",
        ),
        (
            (0..1000).fold(HEADER.to_owned(), |text, k| {
                text + &rows("yard", 70, 5, k, 0.001, 1.0)
            }),
            "f, line 242, hypothesis: more than 20 hypotheses of `yard` observed until 70 pedestrian 5",
        ),
        (
            first.clone() + "\n\n\"yard\",70,5,0,\"1,80,2,0,ok\n" + &second,
            "f, line 16: a quote is opened and not closed on this line",
        ),
        (
            HEADER.to_owned() + "\"",
            "f, line 2: a quote is opened and not closed on this line",
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
            good.replacen("\"e\": 190", "\"e\": 210", 1),
            "f, line 2, scene 0: the scene has the frames 0 to 210; the window that starts there has the observed frames 0, 10 to 70 and the forecast \
             frames 80, 90 to 190: a scene is 8 or 9 observed and 12 forecast frames",
        ),
        (
            good.clone() + &own.lines().next().unwrap().replace("190", "200"),
            "f, line 14, prediction_number 0: 13 positions",
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
            good.replacen("\"p\": 3, \"x\"", "\"p\": 3, \"p\": 5, \"x\"", 1),
            "f, line 2, track.p: is there twice; keep one",
        ),
        (
            good.clone() + &scene(1, 5, 0) + &tracks(1, 5, 1, 70, 1.0),
            "f, line 15, prediction_number: the hypotheses of observed until 70 pedestrian 5 have the numbers 1, \
             expected 0 as before",
        ),
        (
            (0..1000).fold(scene(0, 3, 0), |text, k| text + &tracks(0, 3, k, 70, 1.0)),
            "f, line 242, track.prediction_number: more than 20 hypotheses of observed until 70 pedestrian 3",
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
fn positions_beyond_every_map_are_named_with_their_place() {
    let far = |expected: &str| {
        format!(
            "f, line {expected}: must lie within 10000000 m of the origin, found 1000000000000000000000000000000"
        )
    };
    let positions = format!("{{\"positions\":{:?}}}", still(2.0, 0.0));
    let json = line(70, 3, &positions.replacen("[2.0", "[1e30", 1));
    let goal = line(70, 3, &positions.replacen('{', "{\"goal\":[0,1e30],", 1));
    check(
        ForeignFormat::JsonLines,
        &json,
        &far("1, hypotheses[0].positions[0]"),
    );
    check(
        ForeignFormat::JsonLines,
        &goal,
        &far("1, hypotheses[0].goal"),
    );
    let table = HEADER.to_owned() + &rows("yard", 70, 3, 0, 1.0, 1e30);
    let complaint = complaint(&table, ForeignFormat::Table);
    assert!(
        complaint.starts_with("f, line 2, x, y: must lie within"),
        "{complaint}"
    );
    let trajnet = scene(0, 3, 0) + &tracks(0, 3, 0, 70, 1e30);
    check(
        ForeignFormat::TrajNet,
        &trajnet,
        "f, line 2, track.x, track.y: must lie within",
    );
}
