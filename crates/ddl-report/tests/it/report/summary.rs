//! The main tables of a benchmark.

use super::{cells, five_folds, of_forecaster};
use ddl_data::Convention;
use ddl_eval::Protocol;
use ddl_report::Report;

#[test]
fn a_summary_has_every_forecaster_once_under_each_protocol_with_other_errors() {
    let mut rows = Vec::new();
    for (protocol, min_ade) in [(Protocol::Fair, 0.25), (Protocol::Single, 0.5), (Protocol::Published, 0.125)] {
        for seed in [1, 2] {
            let errors = five_folds(protocol, seed, min_ade * seed as f64);
            rows.extend(errors.clone());
            let name = "DDL as packed";
            rows.extend(errors.into_iter().map(|mut row| {
                name.clone_into(&mut row.conditions.forecaster);
                row
            }));
        }
        let baseline = five_folds(protocol, 1, 0.75);
        rows.extend(of_forecaster(baseline, "constant velocity (last step)"));
    }
    let report = Report::new("Results", rows).unwrap();
    let summary = report.summary(Convention::Star).unwrap();
    let (errors, metrics) = summary.split_once("Mean over the folds").unwrap();
    let rows = |text: &'_ str| -> Vec<Vec<String>> {
        let rows = text.lines().filter(|line| line.starts_with('|')).skip(2).map(cells);
        rows.map(|row| row.into_iter().map(str::to_owned).collect()).collect()
    };
    let (errors, metrics) = (rows(errors), rows(metrics));
    let named = |rows: &[Vec<String>]| -> Vec<String> { rows.iter().map(|row| row[..2].join(", ")).collect() };
    let shown = ["DDL, fair", "constant velocity (last step), fair", "DDL, single"];
    let of_errors = [&shown[..], &["Resonance, the best published, best of 20"]].concat();
    assert_eq!(named(&errors[1..]), of_errors);
    assert_eq!(named(&metrics), shown);
    // Means of 0.25 and 0.5 m, with a sample deviation of 0.177 m.
    let errors = &errors[1];
    assert_eq!(errors[2], "0.375/0.750");
    assert_eq!(errors[7], "0.375±0.177/0.750±0.354");
    let metrics = &metrics[0];
    assert_eq!(metrics[2], "0.375 [0.345, 0.405]");
    assert_eq!(metrics[4..8], ["0.333", "25.0", "10.0", "87.5"]);
    assert_eq!(report.summary(Convention::SocialGan), None);
    let mut part = report.rows().to_vec();
    for row in &mut part {
        row.conditions.test_subset = Some("150 of 181 pedestrians".to_owned());
    }
    let part = Report::new("Part", part).unwrap().summary(Convention::Star).unwrap();
    assert!(!part.contains("published"), "{part}");
}
