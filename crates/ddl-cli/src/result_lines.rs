//! Results for people, in the terminal.

use ddl::eval::{Report, ResultRow};
use std::io::Write as _;

/// One line a result, under what it has in common with others; `rest` says where everything else is.
pub(crate) fn print(report: &Report, rest: &str) -> std::io::Result<()> {
    let mut out = std::io::stdout().lock();
    let common = |row: &ResultRow| {
        let c = &row.conditions;
        (c.convention, c.protocol, c.window_rule)
    };
    let mut printed = Vec::new();
    for first in report.rows() {
        let (convention, protocol, rule) = common(first);
        if printed.contains(&common(first)) {
            continue;
        }
        printed.push(common(first));
        writeln!(
            out,
            "\nconvention {convention}, protocol {protocol}, windows {rule}; minADE/minFDE in metres, best of K\n\
             {:10} {:>7} {:>3}  {:15}  forecaster",
            "fold", "walkers", "K", "minADE/minFDE"
        )?;
        for row in report
            .rows()
            .iter()
            .filter(|row| common(row) == common(first))
        {
            let (conditions, scores) = (&row.conditions, &row.scores);
            writeln!(
                out,
                "{:10} {:>7} {:>3}  {:15}  {}",
                conditions.fold,
                scores.pedestrians,
                scores.hypotheses,
                format!("{:.3}/{:.3}", scores.min_ade, scores.min_fde),
                conditions.label()
            )?;
        }
    }
    writeln!(out, "\n{rest}")
}
