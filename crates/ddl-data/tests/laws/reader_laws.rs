//! Readers: what is written is read back, and nothing makes them panic.

use ddl_data::{Convention, Format, Observation, PedestrianId, parse_recording};
use proptest::prelude::*;

use crate::recordings;
use crate::written::written;

/// Some observations, each (frame, pedestrian) once.
fn observations() -> impl Strategy<Value = Vec<Observation>> {
    let keys = prop::collection::btree_set((-50_i64..50, -9_i64..9), 1..40);
    (keys, prop::collection::vec((-1e4..1e4, -1e4..1e4), 40)).prop_map(|(keys, places)| {
        let observation = |((frame, id), (x, y))| Observation::new(frame, PedestrianId(id), [x, y]);
        keys.into_iter().zip(places).map(observation).collect()
    })
}

proptest! {
    #[test]
    fn what_is_written_is_read_back_in_any_order_of_rows(
        (sorted, shuffled) in observations()
            .prop_flat_map(|rows| (Just(rows.clone()), Just(rows).prop_shuffle())),
    ) {
        for format in Format::ALL {
            let text = written(&shuffled, format);
            let recording = parse_recording(text.as_bytes(), "f", format).unwrap();
            prop_assert_eq!(recording.observations(), &sorted[..]);
        }
    }

    #[test]
    fn no_bytes_make_a_reader_panic(
        bytes in prop_oneof![
            prop::collection::vec(any::<u8>(), 0..400),
            "[-+0-9.,eEinfaNx \t\r\n\"]{0,200}".prop_map(String::into_bytes),
            "([-+0-9.,eE:{}\\[\\]\"fpxys \n]|track|scene|null|NaN){0,120}".prop_map(String::into_bytes),
        ],
    ) {
        let _ = Format::guess("f".as_ref(), &bytes);
        for format in Format::ALL {
            if let Ok(recording) = parse_recording(&bytes, "f", format) {
                let _ = recording.windows(ddl_data::WindowRule::Published);
            }
        }
    }

    #[test]
    fn no_change_of_a_valid_file_makes_a_reader_panic(
        rows in observations(),
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>(), 0..3), 1..5),
    ) {
        for format in Format::ALL {
            let mut bytes = written(&rows, format).into_bytes();
            for (place, byte, kind) in &changes {
                let index = place.index(bytes.len());
                match kind {
                    0 => bytes[index] = *byte,
                    1 => bytes.insert(index, *byte),
                    _ => bytes.truncate(index.max(1)),
                }
            }
            if let Ok(recording) = parse_recording(&bytes, "f", format) {
                prop_assert!(recording.observations().len() <= rows.len() + 1 + changes.len());
                prop_assert!(recording.observations().iter().flat_map(|o| o.position).all(f64::is_finite));
            }
        }
    }

    /// Overlapping scenes of TrajNet++ repeat tracks: the same track any number of times is one.
    #[test]
    fn tracks_that_scenes_repeat_count_once(
        rows in observations(),
        again in prop::collection::vec(any::<prop::sample::Index>(), 0..9),
    ) {
        let mut text = written(&rows, Format::TrajNet);
        let lines: Vec<String> = text.lines().map(str::to_owned).collect();
        for index in again {
            text += &lines[index.index(lines.len())];
            text.push('\n');
        }
        let recording = parse_recording(text.as_bytes(), "f", Format::TrajNet).unwrap();
        prop_assert_eq!(recording.observations(), &rows[..]);
    }

    /// What is written in a format is guessed to be of it, whatever the file's name says not.
    #[test]
    fn the_format_of_a_file_is_guessed(rows in observations()) {
        for (format, name) in [
            (Format::StarCsv, "f.csv"),
            (Format::SocialGan, "f.txt"),
            (Format::Table, "f.csv"),
            (Format::TrajNet, "f"),
            (Format::Obsmat, "f.txt"),
        ] {
            // four lines of four numbers are taken for a table without its header
            if format != Format::StarCsv || rows.len() != 4 {
                let text = written(&rows, format);
                prop_assert_eq!(Format::guess(name.as_ref(), text.as_bytes()), format);
            }
        }
    }
}

#[test]
fn one_spoiled_field_of_a_real_file_is_found() {
    let Some(dataset) = recordings::load(Convention::SocialGan) else {
        return;
    };
    let rows = dataset.recording("zara01").unwrap().observations().to_vec();
    let text = written(&rows, Format::SocialGan);
    let complaint = |lines: &[String]| {
        let text = lines.join("\n");
        parse_recording(text.as_bytes(), "f", Format::SocialGan)
            .unwrap_err()
            .to_string()
    };
    let mut lines: Vec<_> = text.lines().map(str::to_owned).collect();
    let mut fields: Vec<&str> = lines[3000].split('\t').collect();
    fields[2] = "NaN";
    let spoiled = fields.join("\t");
    let sound = std::mem::replace(&mut lines[3000], spoiled);
    let expected = "f, line 3001, field 3: x must be a finite number";
    assert!(complaint(&lines).starts_with(expected));
    lines[3000] = sound.replacen('\t', "\tNaN", 1);
    // a word is the name of another pedestrian
    assert!(parse_recording(lines.join("\n").as_bytes(), "f", Format::SocialGan).is_ok());
    lines[3000] = lines[17].clone();
    let expected = "f, line 3001: pedestrian";
    let complaint = complaint(&lines);
    assert!(
        complaint.starts_with(expected) && complaint.contains("(line 18)"),
        "{complaint}"
    );
}
