//! Every error names its place.

use ddl_eval::external::{self, Coverage, ExternalFormat};

use super::files::{HEADER, complaint, hypothesis, line, rows, scene, tracks, whole, windows};

fn check(format: ExternalFormat, text: &str, expected: &str) {
    let complaint = complaint(text, format);
    let expected = format!("f, line {expected}");
    assert!(complaint.starts_with(&expected), "{text}\n{complaint}\n{expected}");
}

/// Cases, one on each line: parts of the file, then the expected error, between arrows. A line continues on the next
/// after a backslash.
fn check_all(format: ExternalFormat, cases: &str, file: impl Fn(&[&str]) -> String) {
    for case in cases.trim().replace("\\\n", "").lines() {
        let parts: Vec<&str> = case.split(" =>").map(str::trim).collect();
        let (expected, parts) = parts.split_last().unwrap();
        check(format, &file(parts), expected);
    }
}

fn edited(good: &str, from: &str, to: &str) -> String {
    assert!(good.contains(from), "{from}");
    good.replacen(from, &to.replace("\\n", "\n"), 1)
}

#[test]
fn every_mistake_of_json_lines_is_named_with_its_place() {
    let format = ExternalFormat::JsonLines;
    let first = line(70, 3, &hypothesis(1.0));
    check(format, "", "1: the file holds no forecast");
    check(format, &"[".repeat(100_000), "1: not a JSON object");
    let second_lines = r#"
[1] => 2: not a JSON object
{"observed_until":70, => 2: not a JSON object
{"pedestrian":5,"hypotheses":[]} => 2, observed_until: is missing
{"observed_until":70,"hypotheses":[]} => 2, pedestrian: is missing
{"observed_until":70,"pedestrian":5} => 2, hypotheses: is missing
{"observed_until":70,"pedestrian":5,"hypotheses":[]} => 2: at least one hypothesis
{"observed_until":70,"pedestrian":5,"hypotheses":{}} => 2, hypotheses: must be a list, found {}
{"observed_until":70,"pedestrian":5,"hypotheses":[7]} => 2, hypotheses[0]: must be an object, found 7
{"observed_until":70,"pedestrian":5,"hypotheses":[{}]} => 2, hypotheses[0].positions: is missing
{"observed_until":70.5,"pedestrian":5,"hypotheses":[]} => 2, observed_until: must be a whole number, found 70.5
{"recording":7,"observed_until":70,"pedestrian":5,"hypotheses":[]} => 2, recording: must be a name in quotes
"#;
    check_all(format, second_lines, |parts| first.clone() + parts[0]);
    let edits = r#"
[2.0, 0.0], => => 2, hypotheses[0].positions: 11 positions; a forecast has 12
0.0], [2.0 => 0.0], [NaN => 2, hypotheses[0].positions[1][0]: must be a finite number, found null, NaN or infinity
0.0], [2.0 => 0.0], [null => 2, hypotheses[0].positions[1][0]: must be a finite number, found null, NaN or infinity
0.0], [2.0 => 0.0], [-Infinity => 2, hypotheses[0].positions[1][0]: must be a finite number, found null, NaN or infinity
0.0], [2.0 => 0.0], ["2" => 2, hypotheses[0].positions[1][0]: must be a finite number, found "2"
0.0], [2.0 => 0.0], [1e999 => 2: not a JSON object: number out of range
0.0], [2.0 => 0.0], [2.0, 3.0 => 2, hypotheses[0].positions[1]: must be [x, y] in metres, found [2.0,3.0,0.0]
"pedestrian":5 => "pedestrian":3 => 2: line 1 already forecasts this pedestrian
"pedestrian":5 => "pedestrian":3,"pedestrian":5 => 2, pedestrian: appears twice; keep one
{"positions":[[2.0 => {"goal":[1,2],"positions":[[2.0 => 2: all hypotheses of the file must have goals
{"positions":[[2.0 => {"positions":[[1e30 => 2, hypotheses[0].positions[0]: must lie within 10000000 m of the origin
{"positions":[[2.0 => {"goal":[0,1e30],"positions":[[2.0 => 2, hypotheses[0].goal: must lie within 10000000 m
{ => {"frames":[71,72,73,74,75,76,77,78,79,80,81,82], => 1, frames: the forecast has the frames 71, 72 to 82; the 12 \
after the last observed one are 80, 90 to 190
"#;
    let both = first.clone() + &line(70, 5, &hypothesis(2.0));
    check_all(format, edits, |parts| {
        // The common start of both lines is replaced in the second, unless it is only a brace.
        let start = if parts[0] == "{" { 0 } else { first.len() };
        both[..start].to_owned() + &edited(&both[start..], parts[0], parts[1])
    });
}

#[test]
fn every_mistake_of_several_hypotheses_is_named_with_its_place() {
    let format = ExternalFormat::JsonLines;
    let first = line(70, 3, &hypothesis(1.0));
    let twice = hypothesis(1.0) + "," + &hypothesis(2.0);
    check(
        format,
        &(first + &line(70, 5, &twice)),
        "2: 2 hypotheses, but 1 on line 1",
    );
    // Fields of two hypotheses. Some programs write a list of nulls for a goal of NaN, which is an error; a plain null
    // means no goal.
    let pairs = r#"
"weight":0.5, => => 1, hypotheses: all hypotheses of a pedestrian must have weights
"weight":0.5, => "weight":NaN, => 1, hypotheses[1].weight: must be a finite number
"weight":0.5, => "weight":null, => 1, hypotheses[1].weight: must be a finite number, found null, NaN or infinity
"goal":[null,null], => "goal":[1,2], => 1, hypotheses[0].goal[0]: must be a finite number
"goal":[1,2], => "goal":null, => 1, hypotheses[1].goal: is missing
"goal":[1,2], => => 1, hypotheses[1].goal: is missing
"weight":0.5, => "weight":0.5,"weight":0.5, => 1, hypotheses[1].weight: appears twice
"weight":0.5, => "weight":0.6, => 1, weight: the weights sum to 1.1
"weight":1.5, => "weight":-0.5, => 1, weight: a weight must not be below 0, found -0.5
"#;
    check_all(format, pairs, |parts| {
        let with = |field: &&str| hypothesis(1.0).replacen('{', &format!("{{{field}"), 1);
        let both: Vec<String> = parts.iter().map(with).collect();
        line(70, 5, &both.join(","))
    });
    let many = line(70, 5, &vec![hypothesis(1.0); 21].join(","));
    let expected = "1, hypotheses: more than 20 hypotheses of observed until 70 pedestrian 5; the protocols allow 20";
    check(format, &many, expected);
}

#[test]
fn every_mistake_of_a_table_is_named_with_its_place() {
    let format = ExternalFormat::Table;
    let first = HEADER.to_owned() + &rows("yard", 70, 3, 0, 1.0, 1.0);
    let second = rows("yard", 70, 5, 0, 1.0, 2.0);
    check(format, "", "1: the file holds no forecast");
    check(format, HEADER, "1: the file holds no forecast");
    let short = "observed_until,pedestrian,x,y\n";
    check(format, short, "1: the header must name");
    let twice = HEADER.replace("certified", "x");
    check(format, &twice, "1: the header must name");
    check(
        format,
        &(HEADER.to_owned() + "\""),
        "2: a quote is not closed on this line",
    );
    let edits = r#"
,ok => => 14: 8 fields where the header names 9
,70, => ,seventy, => 14, observed_until: must be a whole number, found "seventy"
,2,0,ok => ,NaN,0,ok => 14, x: must be a finite number, found "NaN"
,2,0,ok => ,2,inf,ok => 14, y: must be a finite number, found "inf"
,2,0,ok => ,1e30,0,ok => 14, x, y: must lie within 10000000 m of the origin, found 1000000000000000000000000000000
,1,80, => ,,80, => 14, weight: must be a finite number, found ""
,1,90, => ,0.5,90, => 15, weight: weight 0.5, but 1 in the row before
,80, => ,81, => 14, frames: the forecast has the frames 81, 90 to 190
yard,70,5,0,1,80,2,0,ok => => 15: 11 positions; a forecast has 12
yard,70,5,0,1,80,2,0,ok => yard,70,5,0,1,80,2,0,ok\nyard,70,5,0,1,80,2,0,ok => 26: 13 positions
yard => \n\n"yard",70,5,0,"1,80,2,0,ok\nyard => 16: a quote is not closed on this line
"#;
    check_all(format, edits, |parts| {
        first.clone() + &edited(&second, parts[0], parts[1])
    });
    // Pedestrian, hypothesis and weight of each row.
    let sequences = r"
3/0/1 5/0/1 3/0/1 => 26: line 2 already forecasts this pedestrian
3/0/1 5/0/0.5 5/1/0.5 5/0/0.5 => 38, hypothesis: hypothesis 0 appeared before
3/0/1 5/0/0.5 => 14, weight: the weights sum to 0.5
5/2/0.5 5/0/0.5 => 2, hypothesis: the hypotheses of `yard` observed until 70 pedestrian 5 have the numbers 0, 2, \
expected 0 to 1 or 1 to 2
3/0/1 5/1/1 => 14, hypothesis: the hypotheses of `yard` observed until 70 pedestrian 5 have the numbers 1, expected 0 \
as before
";
    let text_of = |sequence: &str| {
        let part = |part: &str| {
            let numbers: Vec<f64> = part.split('/').map(|n| n.parse().unwrap()).collect();
            rows("yard", 70, numbers[0] as i64, numbers[1] as i64, numbers[2], 1.0)
        };
        HEADER.to_owned() + &sequence.split(' ').map(part).collect::<String>()
    };
    check_all(format, sequences, |parts| text_of(parts[0]));
    let many: Vec<String> = (0..1000).map(|k| format!("5/{k}/0.001")).collect();
    let expected = "242, hypothesis: more than 20 hypotheses of `yard` observed until 70 pedestrian 5";
    check(format, &text_of(&many.join(" ")), expected);
}

#[test]
fn every_mistake_of_trajnet_is_named_with_its_place() {
    let format = ExternalFormat::TrajNet;
    let observed = tracks(0, 3, 0, 70, 1.0);
    let good = scene(0, 3, 0) + &observed;
    check(format, &scene(0, 3, 0), "1: the file holds no forecast");
    let edits = r#"
"scene_id": 0 => "x2": 0 => 2, track.scene_id: is missing
"x": 1.0 => "x": NaN => 2, track.x: must be a finite number, found null, NaN
"x": 1.0 => "x": 1e30 => 2, track.x, track.y: must lie within 10000000 m of the origin
"f": 80 => "f": 80.5 => 2, track.f: must be a whole number
"f": 80 => "f": 81 => 2, prediction_number 0: the forecast has the frames 81, 90 to 190
"e": 190 => "e": 210 => 2, scene 0: the scene has the frames 0 to 210; the window that starts there
"p": 3, => => 1, scene.p: is missing
{"scene": { => {"scene": [{ => 1: not a JSON object
{"scene": { => {"scene": 7, "other": { => 1, scene: must be an object, found 7
"p": 3, "x" => "p": 3, "p": 5, "x" => 2, track.p: appears twice; keep one
"#;
    check_all(format, edits, |parts| edited(&good, parts[0], parts[1]));
    // Scenes (id, primary pedestrian, start) and their tracks (scene, pedestrian, number, last observed frame, x).
    let sequences = r"
T0/3/0/70/1 => 1, track.scene_id: scene 0 has no scene line before its tracks
S0/3/0 T0/3/0/70/1 S0/5/0 => 14, scene.id: scene 0 ended on an earlier line
S0/3/0 T0/3/0/70/1 S1/5/0 T1/5/0/70/1 T0/3/0/70/1 => 27, track.scene_id: scene 0 ended
S0/3/0 T0/3/0/70/1 S1/5/0 T1/5/1/70/1 => 15, prediction_number: the hypotheses of observed until 70 pedestrian 5 have \
the numbers 1, expected 0 as before
S0/3/0 T0/3/0/70/1 T0/5/0/70/1 S1/3/10 T1/5/0/80/2 S2/4/0 T2/5/0/70/2 => 40: pedestrian 5 is a neighbour in two \
scenes that forecast it differently (line 14)
";
    let text_of = |sequence: &str| {
        let part = |part: &str| {
            let (kind, numbers) = part.split_at(1);
            let n: Vec<i64> = numbers.split('/').map(|n| n.parse().unwrap()).collect();
            match kind {
                "S" => scene(n[0], n[1], n[2]),
                _ => tracks(n[0], n[1], n[2], n[3], n[4] as f64),
            }
        };
        sequence.split(' ').map(part).collect::<String>()
    };
    check_all(format, sequences, |parts| text_of(parts[0]));
    let one_more = good + &observed.lines().next().unwrap().replace("190", "200");
    check(format, &one_more, "14, prediction_number 0: 13 positions");
    let many = (0..1000).fold(scene(0, 3, 0), |text, k| text + &tracks(0, 3, k, 70, 1.0));
    let expected = "242, track.prediction_number: more than 20 hypotheses of observed until 70 pedestrian 3";
    check(format, &many, expected);
}

#[test]
fn text_that_is_not_utf8_is_refused_at_its_line() {
    let mut bytes = whole().into_bytes();
    bytes.extend(b"\xff\xfe\n");
    for format in ExternalFormat::ALL {
        let (text, line): (&[u8], usize) = match format {
            ExternalFormat::JsonLines => (&bytes, 4),
            _ => (b"\n\xff", 2),
        };
        let error = external::read_from(text, "f", format, &windows(), Coverage::Whole);
        let expected = format!("f, line {line}: the text is not UTF-8");
        assert_eq!(error.unwrap_err().to_string(), expected);
    }
}
