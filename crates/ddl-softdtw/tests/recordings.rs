//! The search on windows of the real recordings, against evaluating every candidate in `f64` and the log domain.
#![allow(clippy::unwrap_used, reason = "a test may panic")]
#![expect(clippy::print_stdout, reason = "says why nothing is compared, and what was measured")]

#[path = "../benches/recordings/mod.rs"]
mod recordings;

use ddl_softdtw::{Cost, SearchIndex, SoftDtw};
use recordings::{Walk, Windows};

/// Real windows, or `None` (with the reason printed) if they may be absent.
fn windows(steps: usize) -> Option<Windows> {
    let windows = Windows::load(steps);
    if windows.source == "real" {
        return Some(windows);
    }
    let reason = "DDL_DATASETS does not name a folder with the recordings (eth.csv, ...)";
    assert!(std::env::var_os("CI").is_none(), "{reason}");
    println!("not compared: {reason}");
    None
}

/// The sorted distances of all candidates, and the distance of each candidate.
fn oracle(dtw: &SoftDtw, query: &Walk, candidates: &[Walk]) -> (Vec<f64>, Vec<f64>) {
    let distances: Vec<f64> = candidates.iter().map(|y| dtw.normalised(query, y).unwrap()).collect();
    let mut sorted = distances.clone();
    sorted.sort_by(f64::total_cmp);
    (sorted, distances)
}

#[test]
fn the_hundred_nearest_are_those_of_the_oracle() {
    let dtw = SoftDtw::new(1.0, Cost::SquaredEuclidean).unwrap();
    for steps in [7, 8] {
        let Some(windows) = windows(steps) else {
            return;
        };
        assert_eq!(windows.candidates.len(), 36_784);
        let index = SearchIndex::build(&dtw, &windows.candidates).unwrap();
        let mut worst = 0.0_f64;
        let mut queries = windows.some_queries(12);
        // Standing pedestrians are the hardest case, because thousands of candidates are nearly equal.
        let speed = |walk: &Walk| walk.iter().map(|v| v[0].hypot(v[1])).sum::<f64>();
        queries.extend(
            windows
                .candidates
                .iter()
                .filter(|w| speed(w) < 0.02)
                .step_by(900)
                .take(4)
                .cloned(),
        );
        for query in &queries {
            let neighbours = index.nearest(query, 100).unwrap();
            let (sorted, distances) = oracle(&dtw, query, &windows.candidates);
            for (neighbour, expected) in neighbours.iter().zip(&sorted) {
                worst = worst.max((neighbour.distance - distances[neighbour.index]).abs());
                // Up to ties: the k-th distance is the k-th of the oracle.
                assert!((neighbour.distance - expected).abs() < 1e-12);
            }
            let clear = sorted[99] - 1e-12;
            for (index, &distance) in distances.iter().enumerate() {
                let is_present = neighbours.iter().any(|n| n.index == index);
                assert!(is_present || distance >= clear, "{index} at {distance} is missing");
            }
        }
        assert!(worst < 1e-12, "{worst:e}");
        println!("{steps} steps, {} queries: largest error {worst:e}", queries.len());
    }
}
