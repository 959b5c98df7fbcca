//! Pictures and tables as they were when somebody looked at them.
//!
//! `DDL_WRITE_PICTURES=1` writes them again: look at every picture that changes.

use ddl_core::{Forecast, HORIZON, Pace, PedestrianId, Position, RegionTable, Spread, Window};
use ddl_report::page::Page;
use ddl_report::{Report, figure};
use std::path::Path;

fn compare(name: &str, found: &str) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/reference").join(name);
    if std::env::var_os("DDL_WRITE_PICTURES").is_some() {
        std::fs::write(&path, found).unwrap();
    }
    let expected = std::fs::read_to_string(&path).unwrap();
    let pairs = found.lines().zip(expected.lines());
    for (number, (found, expected)) in (1..).zip(pairs) {
        assert_eq!(found, expected, "{name}, line {number}; DDL_WRITE_PICTURES=1 writes it again");
    }
    assert_eq!(found.len(), expected.len(), "{name} has another length");
}

/// Three who walk apart on bent ways.
fn tracks() -> Vec<Vec<Position>> {
    let track = |i: usize| {
        let [start, speed, bend] = [[1.0, 0.3, 0.02], [9.0, -0.45, -0.01], [4.0, 0.05, 0.03]][i];
        let along = move |t: f64| [start + speed * t, 2.0 + 1.7 * i as f64 + bend * t * t - 0.1 * t];
        (0..20).map(|t| along(f64::from(t))).collect()
    };
    (0..3).map(track).collect()
}

#[test]
fn a_scene() {
    let ids = [3, 12, 40].map(PedestrianId).to_vec();
    let window = Window::new("yard", 120, 10, ids, tracks()).unwrap();
    let mut paths = Vec::new();
    for (i, k) in (0..3).flat_map(|i| (0..4).map(move |k| (i, k))) {
        let [.., before, last] = window.observed(i) else { unreachable!("8 positions") };
        let turn = [0.0, 0.06, -0.04, 0.11][k];
        let step = [last[0] - before[0] - turn, last[1] - before[1] + turn * (1.0 + i as f64)];
        paths.extend((1..=HORIZON).map(|t| [0, 1].map(|axis| last[axis] + t as f64 * step[axis])));
    }
    let goals = paths.iter().skip(HORIZON - 1).step_by(HORIZON).map(|[x, y]| [x + 0.3, y - 0.2]).collect();
    let weights = [[0.4, 0.3, 0.2, 0.1], [0.1, 0.5, 0.15, 0.25], [0.25; 4]].concat();
    let spread = Spread {
        scales: (0..3 * HORIZON).map(|at| 0.03 * (at % HORIZON + 1 + at / HORIZON) as f64).collect(),
        paces: vec![Pace::Walking, Pace::Walking, Pace::Slow],
        regions: RegionTable::of(&[&[[1.5; HORIZON]; 9], &[[2.0; HORIZON]; 9], &[[2.5; HORIZON]; 9]], &[0.5, 0.9])
            .unwrap()
            .into(),
    };
    let forecast = Forecast::new(3, 4, paths, weights, Some(goals)).unwrap().with_spread(spread).unwrap();
    compare("scene.svg", &figure::scene(&window, &forecast).unwrap());
}

#[test]
fn a_place() {
    let several = (0..4).flat_map(|turn| {
        let moved = move |[x, y]: Position| [x + 0.4 * f64::from(turn % 2), y * (1.0 - 0.1 * f64::from(turn))];
        tracks().into_iter().map(move |track| track.into_iter().map(moved).collect::<Vec<_>>())
    });
    compare("place.svg", &figure::place("Yard & hall", "12 tracks of 8 s", &several.collect::<Vec<_>>()));
}

/// Scores of two forecasters and three baselines on three folds of simulated crowds, two seeds, under all protocols.
#[test]
fn tables_and_the_head_of_a_page() {
    let report = Report::from_json(include_str!("../reference/report.json")).unwrap();
    compare("report.txt", &report.to_markdown());
    let html = Page::new(&report).to_html().unwrap();
    let (_, head) = html.split_once("<section class=\"headline\"").unwrap();
    let (head, _) = head.split_once("id=\"player\"").unwrap();
    // One element a line, so that a difference is found.
    compare("head.html", &head.replace("><", ">\n<"));
}
