//! Results for people, in the terminal.

use ddl::Protocol;
use ddl::eval::{Report, ResultRow};
use std::fmt::{Result, Write as _};

/// One line a result, under what it has in common with others; `rest` says where everything else is.
pub(crate) fn lines(report: &Report, rest: &str) -> String {
    let mut text = String::new();
    // a `String` takes everything
    let _ = write_lines(&mut text, report, rest);
    text
}

fn write_lines(out: &mut String, report: &Report, rest: &str) -> Result {
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
        let (errors, of) = match protocol {
            Protocol::Single => ("ADE/FDE", "of one hypothesis"),
            _ => ("minADE/minFDE", "best of K"),
        };
        writeln!(
            out,
            "\nconvention {convention}, protocol {protocol}, windows {rule}; {errors} in metres, {of}\n\
             {:10} {:>7} {:>3}  {errors:15}  forecaster",
            "fold", "walkers", "K"
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
