//! Readers of files without mistakes, and of binary ones.

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
