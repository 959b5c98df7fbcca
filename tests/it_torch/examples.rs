//! Every example of the crates with libtorch runs and prints what it is for, or is listed with the reason why not.

use ddl_tests::{example, own_tracks};
use std::collections::BTreeSet;
use std::path::Path;

/// Those that the tests below run.
const RUN: [&str; 3] = ["forecast_csv", "live", "training_steps"];
/// Those that are not run here, and why.
const ELSEWHERE: [(&str, &str); 4] = [
    (
        "calibrate",
        "it writes constants, from recordings of other places",
    ),
    (
        "elsewhere",
        "it measures recordings of other places, for minutes",
    ),
    ("draw_forecast", "it draws a run's own test scene"),
    (
        "one_forecast",
        "it measures a run's validation recordings, for minutes",
    ),
];

#[test]
fn a_csv_is_forecast_with_goals_weights_and_certificates() {
    let folder = tempfile::tempdir().unwrap();
    let run =
        |arguments: &str| example::run("ddl", "forecast_csv", folder.path(), arguments).succeeds();
    let made_up = run("");
    assert!(made_up.starts_with("pavement, frame 9: 3 people, 20 hypotheses each\n"));
    assert!(made_up.contains("pedestrian 3, now at (4.90, -0.30) m, seen at 4 of 8 steps"));
    assert_eq!(made_up.matches("nearer at every step").count(), 3 * 3);
    assert!(made_up.ends_with("all 60 certificates hold\n"), "{made_up}");

    let table = own_tracks::csv(&own_tracks::three_people(9));
    std::fs::write(folder.path().join("mine.csv"), table).unwrap();
    let mine = run("mine.csv");
    assert!(mine.starts_with("mine.csv, frame 80: 3 people"), "{mine}");
    let error = example::run("ddl", "forecast_csv", folder.path(), "none.csv");
    assert!(error.stderr.contains("none.csv: "), "{error:?}");
}

#[test]
fn tracks_are_played_live() {
    let folder = tempfile::tempdir().unwrap();
    let table = own_tracks::csv(&own_tracks::three_people(9));
    std::fs::write(folder.path().join("mine.csv"), table).unwrap();
    let models = Path::new(env!("CARGO_MANIFEST_DIR")).join("../crates/ddl/models");
    let model = models.join("hotel.safetensors").canonicalize().unwrap();
    let arguments = format!("{} mine.csv", model.display());
    let output = example::run("ddl", "live", folder.path(), &arguments).succeeds();
    assert!(
        output.contains("frame 60: 3 seen, nobody for 8 frames yet"),
        "{output}"
    );
    assert_eq!(
        output.matches("nearer to its goal at every step").count(),
        2 * 3
    );
}

#[test]
fn training_steps_are_made() {
    let output = example::run("ddl-star", "training_steps", Path::new("."), "1 0.1").succeeds();
    assert_eq!(output, "1 steps, dropout 0.1\n");
}

/// An example that is added is run from then on.
#[test]
fn no_example_is_forgotten() {
    let known = RUN.into_iter().chain(ELSEWHERE.map(|(name, _)| name));
    let known: BTreeSet<String> = known.map(str::to_owned).collect();
    let found: BTreeSet<String> = ["ddl", "ddl-star"]
        .into_iter()
        .flat_map(example::all_of)
        .collect();
    assert_eq!(found, known);
}
