//! Readers of files without mistakes, and of binary ones.

use ddl_core::PedestrianId;
use ddl_data::{Format, Observation, parse_recording};

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
    for case in include_str!("readers.txt").lines().skip(2) {
        let (name, text) = case.split_once(": ").unwrap();
        let text = text.replace("\\n", "\n").replace("\\r", "\r").replace("\\t", "\t").replace("BOM", "\u{feff}");
        let format = Format::ALL.into_iter().find(|format| format.name() == name).unwrap();
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
        parse_recording(text.as_bytes(), "f", Format::SocialGan).unwrap().frame_step()
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
