//! Writing of recordings. The reader of the format returns the same numbers.

use std::fmt::Write as _;

use ddl_core::PedestrianName;
use serde_json::json;

use crate::clock::{Clock, FrameNumber, TimeUnit};
use crate::file_error::DataError;
use crate::format::kind::Format;
use crate::observation::Observation;
use crate::recording::Recording;

/// The recording as a file of the format, in order of frames. [`parse_recording`](crate::parse_recording) returns the
/// same positions to the last bit. The frame rate is not written. The height and velocities of [`Format::Obsmat`],
/// which no reader uses, are written as 0.
///
/// # Errors
/// [`DataError::Own`] where pedestrians are words, or rows have times: only [`Format::Table`] and [`Format::TrajNet`]
/// have them.
pub fn write_recording(recording: &Recording, format: Format) -> Result<Vec<u8>, DataError> {
    refuse_what_it_lacks(recording, format)?;
    let observations = recording.observations();
    let name = |seen: &Observation| recording.names().of(seen.pedestrian);
    let unit = recording.time_unit();
    let mut text = String::new();
    match format {
        Format::StarCsv => text += &star_csv(observations),
        Format::SocialGan => lines(&mut text, observations, |seen| {
            let [x, y] = seen.position;
            format!("{}\t{}\t{x:?}\t{y:?}", seen.frame, seen.pedestrian)
        }),
        Format::Obsmat => lines(&mut text, observations, |seen| {
            let [x, y] = seen.position;
            format!("{} {} {x:?} 0 {y:?} 0 0 0", seen.frame, seen.pedestrian)
        }),
        Format::Table => {
            text += time_column(unit);
            text += ",pedestrian,x,y\n";
            lines(&mut text, observations, |seen| {
                let [x, y] = seen.position;
                let when = unit.map_or(FrameNumber::Whole(seen.frame), |unit| time(unit, seen));
                format!("{when},{},{x:?},{y:?}", csv_field(&name(seen)))
            });
        }
        Format::TrajNet => {
            // Its times are dates or seconds.
            let unit = unit.map(|unit| match unit {
                TimeUnit::Dates => unit,
                _ => TimeUnit::Seconds,
            });
            lines(&mut text, observations, |seen| {
                let [x, y] = seen.position;
                let (key, when) = match unit {
                    None => ("f", json!(seen.frame)),
                    Some(unit) => ("t", json!(time(unit, seen))),
                };
                json!({"track": {(key): when, "p": name(seen), "x": x, "y": y}}).to_string()
            });
        }
        _ => {
            let problem =
                format!("the format {format} is only read; use the format {} or {}", Format::Table, Format::TrajNet);
            return Err(DataError::Own { problem });
        }
    }
    Ok(text.into_bytes())
}

fn refuse_what_it_lacks(recording: &Recording, format: Format) -> Result<(), DataError> {
    if matches!(format, Format::Table | Format::TrajNet) {
        return Ok(());
    }
    let mut names = recording.observations().iter().map(|seen| recording.names().of(seen.pedestrian));
    let problem = if let Some(word) = names.find(|name| matches!(name, PedestrianName::Word(_))) {
        format!("the format {format} names pedestrians by numbers, but {word} is a word")
    } else if recording.time_unit().is_some() {
        format!("the format {format} has frame numbers, but these rows have times")
    } else {
        return Ok(());
    };
    let problem = format!("{problem}; use the format {} or {}", Format::Table, Format::TrajNet);
    Err(DataError::Own { problem })
}

fn time(unit: TimeUnit, seen: &Observation) -> FrameNumber {
    Clock::with_stamps(unit).number(seen.frame)
}

fn time_column(unit: Option<TimeUnit>) -> &'static str {
    match unit {
        None => "frame",
        Some(TimeUnit::Seconds | TimeUnit::Dates) => "time",
        Some(TimeUnit::Milliseconds) => "time_ms",
        Some(TimeUnit::Microseconds) => "time_us",
        Some(TimeUnit::Nanoseconds) => "time_ns",
    }
}

fn lines(text: &mut String, observations: &[Observation], line: impl Fn(&Observation) -> String) {
    for seen in observations {
        // Writing to a string cannot fail.
        let _ = writeln!(text, "{}", line(seen));
    }
}

/// Four lines: frames, pedestrians, y and x.
fn star_csv(observations: &[Observation]) -> String {
    let line = |field: fn(&Observation) -> String| {
        let fields: Vec<String> = observations.iter().map(field).collect();
        fields.join(",") + "\n"
    };
    line(|seen| seen.frame.to_string())
        + &line(|seen| seen.pedestrian.to_string())
        + &line(|seen| format!("{:?}", seen.position[1]))
        + &line(|seen| format!("{:?}", seen.position[0]))
}

fn csv_field(name: &PedestrianName) -> String {
    let text = name.to_string();
    if text.contains(['"', ',', '\n', '\r']) { format!("\"{}\"", text.replace('"', "\"\"")) } else { text }
}
