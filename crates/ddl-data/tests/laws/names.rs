//! Pedestrians named by words in files and streams.

use std::collections::BTreeSet;

use ddl_core::PedestrianName;
use ddl_data::{Completeness, Format, FrameReader, parse_recording};
use proptest::prelude::*;

type Row = fn(i64, &str) -> String;

#[test]
fn pedestrians_may_be_words() {
    let names = ["12", "7f3e-aa", "007", "1e3"];
    let formats: [(Format, &str, Row); 3] = [
        (Format::Table, "frame,pedestrian,x,y\n", |t, name| format!("{t},{name},{t},0\n")),
        (Format::SocialGan, "", |t, name| format!("{t} {name} {t} 0\n")),
        (Format::TrajNet, "", |t, name| {
            format!("{{\"track\": {{\"f\": {t}, \"p\": \"{name}\", \"x\": {t}, \"y\": 0}}}}\n")
        }),
    ];
    for (format, head, row) in formats {
        let rows = (0..8).flat_map(|t| names.map(|name| row(t, name)));
        let text = head.to_owned() + &rows.collect::<String>();
        let recording = parse_recording(text.as_bytes(), "f", format).unwrap();
        let window = &recording.observed_windows()[0];
        let read_names: Vec<String> = (0..4).map(|i| window.name(i).to_string()).collect();
        assert_eq!(read_names, names, "{format}");
        assert!((0..4).all(|i| window.named(&window.name(i)) == Some(i)));
        let partial = recording.live_tracks().with_completeness(Completeness::Partial);
        assert_eq!(recording.observe(partial).windows[1].name(3), PedestrianName::Word("1e3".to_owned()));
        // A duplicate is reported with its word.
        let twice = text.clone() + text.lines().last().unwrap();
        let read = parse_recording(twice.as_bytes(), "f", format);
        if format != Format::TrajNet {
            let message = read.unwrap_err().to_string();
            assert!(message.contains("pedestrian 1e3 is in frame 7 already"), "{message}");
        }
        // The stream reader returns the same names.
        let mut frames = FrameReader::new(text.as_bytes(), "tracker");
        let mut read = 0;
        while let Some(frame) = frames.next_frame().unwrap() {
            let frame_names: Vec<String> =
                frame.pedestrians.iter().map(|(id, _)| frame.names.of(*id).to_string()).collect();
            assert_eq!(frame_names, names, "{format}");
            read += 1;
        }
        assert_eq!(read, 8);
    }
}

proptest! {
    /// Each id is one pedestrian, of the same number and name in both.
    #[test]
    fn files_and_streams_name_alike(ids in prop::collection::btree_set("[-+0-9ae]{1,4}|[1-9][0-9]?[.]0", 2..5)) {
        prop_assume!(!ids.contains("-1"));
        let rows = (0..3).flat_map(|t| ids.iter().map(move |id| format!("{t},{id},{t},0\n")));
        let text = "frame,pedestrian,x,y\n".to_owned() + &rows.collect::<String>();
        let mut frames = FrameReader::new(text.as_bytes(), "tracker");
        let (mut streamed, mut failed) = (BTreeSet::new(), false);
        loop {
            match frames.next_frame() {
                Ok(Some(frame)) => {
                    streamed.extend(frame.pedestrians.iter().map(|(id, _)| (*id, frame.names.of(*id))));
                }
                Ok(None) => break,
                Err(_) => failed = true,
            }
        }
        let read = parse_recording(text.as_bytes(), "f", Format::Table);
        prop_assert_eq!(read.is_err(), failed, "12 and 12.0 are one number");
        if let Ok(read) = read {
            let seen = read.observations().iter().map(|seen| (seen.pedestrian, read.names().of(seen.pedestrian)));
            prop_assert_eq!(&seen.collect::<BTreeSet<_>>(), &streamed);
            let mut names: Vec<String> = streamed.iter().map(|(_, name)| name.to_string()).collect();
            let mut written: Vec<String> = ids.iter().map(|id| id.trim_end_matches(".0").to_owned()).collect();
            names.sort();
            written.sort();
            prop_assert_eq!(names, written);
        }
    }
}
