//! Mistakes in files and streams are named with their place: the cases of `mistakes.txt`.

use ddl_data::{DataError, Format, FrameReader, parse_columns};

use crate::formats::chosen;

const CASES: &str = include_str!("mistakes.txt");

fn of_file(name: &str, text: &str, format: Option<Format>) -> Option<DataError> {
    let (name, choice) = chosen(name);
    match format.map_or_else(|| Format::guess(name.as_ref(), text.as_bytes(), &choice), Ok) {
        Ok(format) => parse_columns(text.as_bytes(), "f", format, &choice).err(),
        Err(error) => Some(error.into()),
    }
}

fn of_stream(text: &str) -> Option<DataError> {
    let mut frames = FrameReader::new(text.as_bytes(), "f");
    std::iter::from_fn(|| frames.next_frame().transpose()).find_map(Result::err)
}

fn check(case: &str, found: Option<DataError>, expected: &str) {
    let message = found.map_or_else(|| "NONE".to_owned(), |error| error.to_string());
    let is_said = |part: &str| {
        let is_place = part.starts_with("line ");
        message.contains(part) && (!is_place || message.starts_with(&format!("f, {part}")))
    };
    assert!(expected.split(" => ").all(is_said), "{case}: {message}");
}

#[test]
fn every_mistake_is_named_with_its_place() {
    let (_, cases) = CASES.split_once("\n\n").unwrap();
    let mut section = "";
    for case in cases.lines() {
        let Some((text, expected)) = case.split_once("=> ") else {
            section = case.trim_matches(['[', ']']);
            continue;
        };
        let text = text.strip_suffix(' ').unwrap_or(text);
        let (name, text) = match section {
            "guessed" => text.split_once(": ").unwrap(),
            _ => ("", text),
        };
        let text = text.replace("\\n", "\n").replace("\\t", "\t").replace("BELL", "\u{7}");
        let text = text.replace("LONG", &"a".repeat(65)).replace("PLACE7", r#""p":7,"x":0,"y":0"#);
        let (of_the_file, of_the_stream) = expected.split_once(" STREAM ").unwrap_or((expected, expected));
        let format = Format::ALL.into_iter().find(|format| format.name() == section);
        if section != "streamed" {
            check(case, of_file(name, &text, format), of_the_file);
        }
        if ["streamed", "both"].contains(&section) {
            check(case, of_stream(&text), of_the_stream);
        }
    }
}
