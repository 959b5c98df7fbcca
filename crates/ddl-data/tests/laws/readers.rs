//! Readers: every mistake in a file is reported with its place.

use ddl_data::{Format, Observation, PedestrianId, parse_recording};

pub(crate) fn complaint(text: impl AsRef<[u8]>, format: Format) -> String {
    parse_recording(text.as_ref(), "f", format).unwrap_err().to_string()
}

#[test]
fn good_files_are_read() {
    let expected = [
        Observation::new(0, PedestrianId(1), [1.5, -2.0]),
        Observation::new(10, PedestrianId(1), [1.75, -2.0]),
        Observation::new(10, PedestrianId(3), [0.0, 4e-2]),
    ];
    for (format, text) in [
        (Format::StarCsv, "10,0,10\n3,1,1\n4e-2,-2.0,-2\n0,1.5,1.75\n"),
        (Format::StarCsv, "10,0,10\r\n3,1,1\r\n4e-2,-2.0,-2\r\n0,1.5,1.75"),
        (
            Format::SocialGan,
            "10.0\t3.0\t0\t0.04\n0\t1.0\t1.5\t-2\n10\t1\t1.75\t-2\n\n",
        ),
        (Format::SocialGan, "10 3 0 0.04\n  0 1 1.5 -2\n10 1 1.75   -2"),
        (
            Format::Table,
            "frame,pedestrian,x,y\n0,1,1.5,-2\n10,1,1.75,-2\n10,3,0,0.04\n",
        ),
        (
            Format::Table,
            "\u{feff}y, x, pedestrian, frame\n0.04,0,3,10\n-2,1.5,1,0\n-2,1.75,1,10\n",
        ),
        (
            Format::TrajNet,
            r#"{"scene": {"id": 266, "p": 1, "s": 0, "e": 10, "fps": 2.5, "tag": 2}}
{"track": {"f": 0, "p": 1, "x": 1.5, "y": -2}}
{"weather": "fine"}

{"track": {"f": 10.0, "p": 1, "x": 1.75, "y": -2.0, "prediction_number": null}}
{"track": {"f": 10, "p": 3, "x": 0, "y": 4e-2, "height": "tall"}, "more": [1]}
{"track": {"f": 20, "p": 3, "x": 0, "y": 9, "prediction_number": 0, "scene_id": 266}}
{"track": {"f": 10, "p": 3, "x": 0.0, "y": 0.04}}
"#,
        ),
        (
            Format::Obsmat,
            "  0.0000000e+00   1.0000000e+00   1.5000000e+00   0.0000000e+00  \
             -2.0000000e+00   1.6e+00   0.0e+00   1.9e-01\n  \
             1.0000000e+01   1.0000000e+00   1.7500000e+00   0.0000000e+00  \
             -2.0000000e+00   1.6e+00   0.0e+00   NaN\n  \
             1.0000000e+01   3.0000000e+00   0.0000000e+00   0.0000000e+00   \
             4.0000000e-02   1.6e+00   0.0e+00   1.9e-01\n",
        ),
    ] {
        let recording = parse_recording(text.as_bytes(), "f", format).unwrap();
        assert_eq!(recording.observations(), expected, "{format}: {text:?}");
        assert_eq!((recording.name(), recording.frame_step()), ("f", 10));
    }
}

/// Checks cases, one per line: a file, in which `\n` and `\t` are escapes, an arrow, and the beginning of the error
/// message.
fn check(format: Format, cases: &str) {
    for case in cases.lines().filter(|case| !case.is_empty()) {
        let (text, expected) = case.split_once("=> ").unwrap();
        let text = text.trim_end().replace("\\n", "\n").replace("\\t", "\t");
        let complaint = complaint(&text, format);
        let expected = format!("f, line {expected}");
        assert!(complaint.starts_with(&expected), "{case}: {complaint}");
    }
}

const STAR_CSV: &str = r"
=> 1: the file holds no observation
0,1\n1,1\n0,0 => 4: line missing
0\n1\n0\n0\n0 => 5: unexpected line
0,1\n1,1\n0,0\n0,0,0 => 4: 3 fields, but line 1 has 2
0,1\n1,1\n0,0\n0, => 4, field 2: x must be a finite number
0,1\n1,1\nNaN,0\n0,0 => 3, field 1: y must be a finite number
0,1\n1,1\n0,inf\n0,0 => 3, field 2: y must be a finite number
0\n1\n0\n-1e38 => 4, field 1: x must lie within 10000000 m
0,1.5\n1,1\n0,0\n0,0 => 1, field 2: frame must be a whole number
0,1\n1,x\n0,0\n0,0 => 2, field 2: pedestrian must be a whole number
0,1,0\n7,7,7\n0,0,0\n0,0,0 => 2, field 3: pedestrian 7 is in frame 0
";

const SOCIAL_GAN: &str = r"
 \n => 1: the file holds no observation
0\t1\t0\t0\n0\t2\t0 => 2: 3 fields where 4 are expected
0\t1\t0\t0\t9 => 1: 5 fields where 4 are expected
0 1 0 0\n1 1 nan 0 => 2, field 3: x must be a finite number
0 1 0 1e999 => 1, field 4: y must be a finite number
0 1 2e7 0 => 1, field 3: x must lie within 10000000 m
half 1 0 0 => 1, field 1: frame must be a whole number
1e300 1 0 0 => 1, field 1: frame must be a whole number
0 1 0 0\n0 2 0 0\n0 1 5 5 => 3: pedestrian 1 is in frame 0 already (line 1)
";

const TABLE: &str = r"
=> 1: the file holds no observation
frame,pedestrian,x,y\n => 1: the file holds no observation
frame,pedestrian,x\n0,1,2 => 1: the header must name
frame,pedestrian,x,z\n => 1, field 4: the header must name
frame,pedestrian,x,x\n => 1, field 4: the header must name
0,1,2.0,3.0\n => 1: the header must name
frame,pedestrian,x,y\n0,1,2\n => 2: 3 fields where 4 are expected
frame,pedestrian,x,y\n0,1,2,3,4\n => 2: 5 fields where 4 are expected
x,y,frame,pedestrian\n0,0,1,2\n0,-,2,2\n => 3, field 2: y must be
frame,pedestrian,x,y\n0,1,0,1e30 => 2, field 4: y must lie within 10000000 m
frame,pedestrian,x,y\n0,1,2,3\n1,1,2,3\n0,1,2,3\n => 4: pedestrian 1 is
";

const TRAJNET: &str = r#"
=> 1: the file holds no observation
{"scene": {"id": 0}} => 1: the file holds no observation
[1, 2] => 1: the line must be one JSON object
{"track": {"f": 0, " => 1: the line must be one JSON object
{"track": {"f": 0, "p": 2, "x": NaN, "y": 3.0}} => 1: the line must be one JSON object (which has no NaN
{"track": {"f": 0, "f": 1}} => 1: the line must be one JSON object (which has no NaN and no Infinity): track: duplicate
{"track": {}, "track": {}} => 1: the line must be one JSON object (which has no NaN and no Infinity): duplicate field
{"track": {"p": 2, "x": 1, "y": 3.0}} => 1: track.f is missing
{"track": [1, 2, 3, 4]} => 1: track must be a JSON object, found [1, 2, 3, 4]
{"scene": "crowded"} => 1: scene must be a JSON object, found "crowded"
{"track": {"f": 1.5, "p": 2, "x": 1, "y": 3.0}} => 1: track.f must be a whole number
{"track": {"f": 1, "p": " ", "x": 1, "y": 3.0}} => 1: track.p must be a whole number
{"track": {"f": 1, "p": [2], "x": 1, "y": 3.0}} => 1: track.p must be a whole number
{"track": {"f": 1, "p": 2, "x": "1", "y": 3.0}} => 1: track.x must be a finite number
{"track": {"f": 1, "p": 2, "x": 1, "y": null}} => 1: track.y must be a finite number
{"track": {"f": 0, "p": 1, "x": 1e300, "y": 0}} => 1: track.x must lie within 10000000 m
"#;

#[test]
fn every_mistake_of_a_file_is_named_with_its_place() {
    for (format, cases) in [
        (Format::StarCsv, STAR_CSV),
        (Format::SocialGan, SOCIAL_GAN),
        (Format::Table, TABLE),
        (Format::TrajNet, TRAJNET),
        (Format::Obsmat, OBSMAT),
    ] {
        check(format, cases);
    }
    let row = |y| format!(r#"{{"track": {{"f": 0, "p": 1, "x": 2, "y": {y}}}}}"#);
    let message = complaint(format!("{}\n{}\n", row("3"), row("3.5")), Format::TrajNet);
    let expected = "f, line 2: pedestrian 1 is in frame 0 at [2.0, 3.5], but on line 1 at [2.0, 3.0]";
    assert!(message.starts_with(expected), "{message}");
}

const OBSMAT: &str = r"
=> 1: the file holds no observation
0 1 2 3 => 1: 4 fields where 8 are expected
0 1 2 0 3 0 0 0\n1 1 2 0 3 0 0 0 0 => 2: 9 fields where 8 are expected
half 1 2 0 3 0 0 0 => 1, field 1: frame must be a whole number
5 one 2 0 3 0 0 0 => 1, field 2: pedestrian must be a whole number
5 1 NaN 0 3 0 0 0 => 1, field 3: x must be a finite number
5 1 2 up 3 0 0 0 => 1, field 4: z must be a number
5 1 2 0 inf 0 0 0 => 1, field 5: y must be a finite number
0 1 0 0 -2e7 0 0 0 => 1, field 5: y must lie within 10000000 m
5 1 2 0 3 0 0 fast => 1, field 8: v_y must be a number
5 1 2 0 3 0 0 0\n5 1 2 0 3 0 0 0 => 2: pedestrian 1 is in frame 5 already (line 1)
";

#[test]
fn the_most_common_difference_is_the_step() {
    let step = |frames: &[i64]| {
        let rows = frames.iter().map(|frame| format!("{frame} 1 0 0\n"));
        let text: String = rows.collect();
        parse_recording(text.as_bytes(), "f", Format::SocialGan)
            .unwrap()
            .frame_step()
    };
    assert_eq!(step(&[0, 6, 12, 150, 156]), 6);
    assert_eq!(step(&[0, 10, 30]), 10);
    assert_eq!(step(&[7]), 1);
    assert_eq!(step(&[-(1 << 52), 1 << 52]), 1);
}

#[test]
fn binary_files_are_refused() {
    for format in Format::ALL {
        let message = complaint(b"0 1 0 0\n1 1 \xff 0\n", format);
        assert!(message.starts_with("f, line 2: the text is not UTF-8"), "{message}");
    }
    for bytes in [&b"\x1f\x8b\x08\x00"[..], b"PK\x03\x04\x14"] {
        let message = complaint(bytes, Format::Table);
        assert!(message.contains("is compressed"), "{message}");
    }
}

#[test]
fn other_headers_are_read_or_explained() {
    let read = |header: &str| {
        let text = format!("{header}\n0,1,2.0,3.0\n");
        parse_recording(text.as_bytes(), "t", Format::Table)
    };
    let recording = read("Frame,PEDESTRIAN,X,Y").unwrap();
    assert_eq!(
        recording.at(0)[0].position.map(f64::to_bits),
        [2.0_f64, 3.0].map(f64::to_bits)
    );
    let further = parse_recording(b"frame,vx,pedestrian,x,y,note\n0,9,1,2.0,3.0,a\n", "t", Format::Table).unwrap();
    assert_eq!(
        (further.observations(), further.notes()),
        (
            recording.observations(),
            &["the columns vx, note are not read".to_owned()][..]
        )
    );
    let cases = r#"
observed_until,pedestrian,frame,x,y => this is a table of forecasts
frame;pedestrian;x;y => line 2: 1 fields where 4 are expected
frame,pedestrian,x,vx => still missing: y; rename the column that holds it, or name it (--columns y=NAME)
frame,who,x [mile],y [m] => still missing: pedestrian, x; rename
frame,who,x [mile],y [m] => (--columns pedestrian=NAME): unknown are "who", "x [mile]"
frame,pedestrian,x [cm],y [m] => different units
frame,id,track_id,x,y => the columns "id" and "track_id" both say the same; leave
frame,t,ped,x,pos_x,y => the columns "x" and "pos_x" both
frame,id,camera,x,y => rename it scene
[{"frame": 0}] => not a table
0,1,2.5,-3.0 => put a line with the names of the 4 columns above them: frame,pedestrian,x,y
"#;
    for case in cases.trim().lines() {
        let (header, advice) = case.split_once(" => ").unwrap();
        let message = read(header).unwrap_err().to_string();
        assert!(message.contains(advice), "{message}");
    }
}

#[test]
fn other_rows_are_read_or_explained() {
    let cases = r#"
0,1.5,2.0,3.0 => line 2, field 2 => must be a whole number
0,,2.0,3.0 => line 2, field 2 => leave out the row
0,1,"2,5",3.0 => line 2, field 3 => use a decimal point
0,1,2,5,3,0 => line 2 => decimal point
0,1,2.5,3.0,7 => line 2 => 5 fields where 4 are expected
0;1;2.5;3.0 => line 2 => not separated like those of the first line
0,1,,3.0 => line 2, field 3 => leave out the row
"#;
    for case in cases.trim().lines() {
        let mut parts = case.split(" => ");
        let text = format!("frame,pedestrian,x,y\n{}\n", parts.next().unwrap());
        let message = complaint(text, Format::Table);
        assert!(parts.all(|part| message.contains(part)), "{message}");
    }
}
