//! Results for people, in the terminal.

use ddl::eval::Report;
use std::io::Write as _;

/// One line a result, under the conditions that tell it from the others; `rest` says where everything else is.
pub(crate) fn print(report: &Report, rest: &str) -> std::io::Result<()> {
    let mut out = std::io::stdout().lock();
    let mut above = None;
    for row in report.rows() {
        let (conditions, scores) = (&row.conditions, &row.scores);
        let common = (
            conditions.convention,
            conditions.protocol,
            conditions.window_rule,
        );
        if above != Some(common) {
            let (convention, protocol, rule) = common;
            writeln!(
                out,
                "\nconvention {convention}, protocol {protocol}, windows {rule}; minADE/minFDE in metres, best of K\n\
                 {:10} {:>7} {:>3}  {:15}  forecaster",
                "fold", "walkers", "K", "minADE/minFDE"
            )?;
            above = Some(common);
        }
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
    writeln!(out, "\n{rest}")
}
