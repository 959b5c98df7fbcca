//! The program on the real recordings: a tiny run of the fold `hotel`, and its counts.

use ddl::data::{Convention, Dataset, WindowRule};
use ddl::eval::ResultRow;
use ddl::report::Report;
use ddl::{Protocol, RunDirectory};
use ddl_tests::program::{self, Finished};
use ddl_tests::recordings;

/// Windows and walkers of the seven training recordings under the complete rule, counted by an
/// independent program.
const TRAINING: (usize, usize) = (4569, 38_323);
/// Test windows and walkers of the fold under the published and the complete rule, counted likewise.
const TEST: [(WindowRule, usize, usize); 2] = [
    (WindowRule::Published, 387, 1026),
    (WindowRule::Complete, 413, 1075),
];
const WALKERS: usize = 40;

#[test]
fn a_tiny_run_of_the_hotel_fold() {
    let Some(data) = recordings::star_folder() else {
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    let run_on_data = |command_line: &str| {
        let mut command = program::command(here, command_line);
        let output = command.arg("--data").arg(&data).output().unwrap();
        Finished::new(format!("ddl {command_line}"), &output).succeeds()
    };
    let train = "train --fold hotel --epochs 1 --train-walkers 60 --batch-walkers 30 --proposal-steps 10 --out run \
                 --threads 1";
    assert!(
        run_on_data(train).starts_with("run: trained, 1 epoch\nnext: ddl evaluate --model run")
    );
    let run = RunDirectory::new(here.join("run"));
    let config = run.config().unwrap();
    assert_eq!(config.data.convention, Convention::Star);
    assert_eq!((config.data.windows, config.data.walkers), TRAINING);

    let evaluate = format!(
        "evaluate --model run --protocol published --protocol fair --protocol single \
         --test-walkers {WALKERS} --threads 1"
    );
    let summary = run_on_data(&evaluate);
    for protocol in Protocol::ALL {
        assert!(summary.contains(protocol.name()), "{summary}");
    }
    let report = Report::load(&run.report()).unwrap();
    check(report.rows());

    let dataset = Dataset::load(Convention::Star, &data).unwrap();
    let fold = dataset.fold("hotel").unwrap();
    for (rule, windows, walkers) in TEST {
        let found = fold.test_windows(rule);
        let people: usize = found.iter().map(ddl::data::Window::len).sum();
        assert_eq!((found.len(), people), (windows, walkers), "{rule}");
    }
}

/// Each protocol under each window rule, all rows of one table on the same walkers.
fn check(rows: &[ResultRow]) {
    for protocol in Protocol::ALL {
        let counts = [WindowRule::Published, WindowRule::Complete].map(|rule| {
            let table: Vec<&ResultRow> = rows
                .iter()
                .filter(|row| {
                    (row.conditions.protocol, row.conditions.window_rule) == (protocol, rule)
                })
                .collect();
            let forecasters = table.iter().map(|row| row.conditions.forecaster.as_str());
            assert!(
                forecasters.clone().any(|name| name == "DDL"),
                "{protocol} {rule}"
            );
            assert!(
                forecasters
                    .clone()
                    .any(|name| name.starts_with("constant velocity"))
            );
            for row in &table {
                assert_eq!(row.conditions.fold, "hotel");
                assert_eq!(row.conditions.convention, Convention::Star);
                assert_eq!(row.scores.pedestrians, table[0].scores.pedestrians);
                assert_eq!(row.scores.windows, table[0].scores.windows);
                // real people walk below 3 m/s: no forecast of 4.8 s is off by more than this
                assert!(
                    (0.01..15.0).contains(&row.scores.min_ade),
                    "{:?}",
                    row.scores
                );
            }
            table[0].scores.pedestrians
        });
        let [published, complete] = counts;
        assert!((WALKERS..WALKERS + 30).contains(&complete), "{complete}");
        assert!(
            published > 0 && published <= complete,
            "{published} of {complete}"
        );
    }
}
