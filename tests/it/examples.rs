//! Every example of the crates that needs no libtorch runs and prints its result.

use ddl_tests::example;
use ddl_tests::place::Place;
use std::collections::BTreeSet;
use std::path::Path;

/// The sample recording of the repository, which an example makes.
const SAMPLE: &str = include_str!("../../datasets/sample.csv");

/// Crate, example and arguments, and what its output must hold. An example that receives the name of a picture draws
/// it.
const EXAMPLES: [(&str, &[&str]); 2] = [
    ("ddl-forecast draw_forecast sample.csv 15 forecast.svg", &[]),
    ("ddl-data sample_recording", &[SAMPLE]),
];

/// Crate, example, and the rest of the line.
fn parts(line: &str) -> (&str, &str, &str) {
    let (package, rest) = line.split_once(' ').unwrap();
    let (name, arguments) = rest.split_once(' ').unwrap_or((rest, ""));
    (package, name, arguments)
}

#[test]
fn every_example_runs_and_prints_the_expected_texts() {
    let place = Place::empty();
    place.write("sample.csv", SAMPLE);
    for (line, promises) in EXAMPLES {
        let (package, name, arguments) = parts(line);
        let output = example::run(package, name, place.path(), arguments).succeeds();
        for promise in promises {
            assert!(output.contains(promise), "{line}: no {promise:?} in\n{output}");
        }
        if let Some(picture) = arguments
            .split(' ')
            .find(|word| Path::new(word).extension().is_some_and(|extension| extension == "svg"))
        {
            let svg = place.text(picture);
            assert!(svg.contains("<svg") && svg.trim_end().ends_with("</svg>"), "{line}");
        }
    }
}

#[test]
fn no_example_is_forgotten() {
    let listed: BTreeSet<String> = EXAMPLES.map(|(line, _)| parts(line).1.to_owned()).into();
    let crates = Path::new(env!("CARGO_MANIFEST_DIR")).join("../crates");
    let folders = std::fs::read_dir(crates).unwrap().map(|entry| entry.unwrap().path());
    let folders = folders.filter(|folder| !folder.ends_with("ddl-star"));
    let examples = folders.flat_map(|folder| example::all_of(&folder));
    assert_eq!(examples.collect::<BTreeSet<_>>(), listed);
}
