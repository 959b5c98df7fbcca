//! Every example of the crates without libtorch runs and prints what it is for.

use ddl_tests::example;
use std::collections::BTreeSet;
use std::path::Path;

/// Crate, example, arguments, and what its output must hold; or, of one that draws, the file that must be a picture.
const EXAMPLES: [(&str, &str, &str, Promise); 8] = [
    (
        "ddl-data",
        "tracks_to_windows",
        "",
        Promise::Says(&[
            "street.csv: format table, 50 positions of 3 people, 10 frames a step of 0.4 s",
            "street.ndjson: format trajnet, 50 positions of 3 people",
            "pedestrian 2 at (1.88, 0.80) m; of 8 positions 6 seen, 2 filled in, 0 before it came",
            "pedestrian 3 at (4.00, -1.92) m; of 8 positions 4 seen, 0 filled in, 4 before it came",
        ]),
    ),
    (
        "ddl-softdtw",
        "nearest_neighbours",
        "",
        Promise::Says(&[
            "turns left after 0.4 s, at 1.20 m/s",
            "an exhaustive search agrees",
        ]),
    ),
    (
        "ddl-softdtw",
        "throughput",
        "8 2 portable",
        Promise::Says(&["ns a pair"]),
    ),
    (
        "ddl-dynamics",
        "reaching",
        "",
        Promise::Says(&[
            "at the end: 0.000000 m from the cup; least clearance 0.0",
            "certificate: holds, nearer to the cup at every step",
            "plain Euler steps: step 43 does not approach the goal",
        ]),
    ),
    (
        "ddl-dynamics",
        "circling",
        "circling.svg",
        Promise::Draws("circling.svg"),
    ),
    (
        "ddl-dynamics",
        "around",
        "around.svg",
        Promise::Draws("around.svg"),
    ),
    (
        "ddl-goal",
        "goals_of_a_walker",
        "",
        Promise::Says(&["300 experts of 3000 walkers", "nearest goal: 0."]),
    ),
    (
        "ddl-report",
        "score_forecasts",
        "",
        Promise::Says(&["2284 walkers of the simulated plaza", "protocol `single`"]),
    ),
];

/// Those that are not run here, and why.
const ELSEWHERE: [(&str, &str, &str); 2] = [
    (
        "ddl-report",
        "report_page",
        "`cargo xtask page` runs it and checks what it makes in a browser",
    ),
    (
        "ddl-goal",
        "goal_validation",
        "it measures all recordings, for minutes",
    ),
];

enum Promise {
    Says(&'static [&'static str]),
    Draws(&'static str),
}

#[test]
fn every_example_runs_and_keeps_its_promise() {
    let folder = tempfile::tempdir().unwrap();
    for (package, name, arguments, promise) in EXAMPLES {
        let output = example::run(package, name, folder.path(), arguments).succeeds();
        match promise {
            Promise::Says(lines) => {
                for line in lines {
                    assert!(output.contains(line), "{name}: no {line:?} in\n{output}");
                }
            }
            Promise::Draws(file) => {
                let svg = std::fs::read_to_string(folder.path().join(file)).unwrap();
                assert!(
                    svg.contains("<svg") && svg.ends_with("</svg>\n") || svg.ends_with("</svg>"),
                    "{name}"
                );
            }
        }
    }
}

/// An example that is added is run from then on.
#[test]
fn no_example_is_forgotten() {
    for package in [
        "ddl-data",
        "ddl-softdtw",
        "ddl-dynamics",
        "ddl-goal",
        "ddl-eval",
        "ddl-report",
    ] {
        let run = EXAMPLES.iter().map(|(of, name, ..)| (*of, *name));
        let elsewhere = ELSEWHERE.iter().map(|(of, name, _)| (*of, *name));
        let known: BTreeSet<String> = run
            .chain(elsewhere)
            .filter(|(of, _)| *of == package)
            .map(|(_, name)| name.to_owned())
            .collect();
        assert_eq!(example::all_of(package), known, "{package}");
    }
}

/// The certificate and the clearance are computed: distances of the table fall, and no clearance is negative.
#[test]
fn the_reaching_hand_comes_nearer_and_touches_nothing() {
    let output = example::run("ddl-dynamics", "reaching", Path::new("."), "").succeeds();
    let rows: Vec<(f64, f64)> = output
        .lines()
        .filter(|line| line.ends_with(" m") && line.contains(" s "))
        .map(|line| {
            let fields: Vec<&str> = line.split_whitespace().collect();
            (fields[5].parse().unwrap(), fields[7].parse().unwrap())
        })
        .collect();
    assert_eq!(rows.len(), 11, "{output}");
    assert!(rows.is_sorted_by(|before, after| after.0 < before.0));
    assert!(rows.iter().all(|row| row.1 > 0.0));
}

/// Of the three forecasts "as fast" is the heaviest: alone, it scores as the baseline that goes on at the mean velocity.
#[test]
fn the_other_programs_heaviest_forecast_scores_as_the_baseline_it_is() {
    let output = example::run("ddl-report", "score_forecasts", Path::new("."), "").succeeds();
    let (_, single) = output.split_once("protocol `single`").unwrap();
    let numbers = |name: &str| -> Vec<String> {
        let line = single
            .lines()
            .find(|line| line.trim_start().starts_with(name));
        let fields = line.unwrap().split_whitespace();
        fields
            .filter(|field| field.parse::<f64>().is_ok())
            .map(str::to_owned)
            .collect()
    };
    let ours = numbers("slower, as fast, faster");
    assert_eq!(ours.len(), 4, "{output}");
    assert_eq!(ours, numbers("constant velocity (mean observed)"));
    assert_ne!(ours, numbers("social force"));
}
