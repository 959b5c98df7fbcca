//! Pedestrians named by words in files and streams.

use ddl_core::{PedestrianId, PedestrianName};
use ddl_data::{Completeness, Format, FrameReader, parse_recording};

type Row = fn(i64, &str) -> String;

#[test]
fn pedestrians_may_be_words() {
    let names = ["7f3e-aa", "12", "007", "1e3"];
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

#[test]
fn a_number_in_a_stream_stays_a_number_when_words_come() {
    let text = "frame,pedestrian,x,y\n0,017,0,0\n1,017,0,0\n2,017,0,0\n2,ab,5,5\n3,017,0,0\n3,ab,5,5\n";
    let mut frames = FrameReader::new(text.as_bytes(), "tracker");
    let mut first = Vec::new();
    while let Some(frame) = frames.next_frame().unwrap() {
        first.push(frame.pedestrians[0].0);
    }
    assert_eq!(first, [PedestrianId(17); 4]);
}
