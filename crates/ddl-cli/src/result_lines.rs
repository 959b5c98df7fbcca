//! Results for people, in the terminal.

use ddl::eval::Report;
use std::io::Write as _;

/// One line a result, under the conditions that tell it from the others.
pub(crate) fn print(report: &Report, rest: &str) -> std::io::Result<()> {
    let mut out = std::io::stdout().lock();
    writeln!(out, "minADE/minFDE in metres; everything else is in {rest}")?;
    for row in report.rows() {
        let (conditions, scores) = (&row.conditions, &row.scores);
        writeln!(
            out,
            "{:6} {:10} {:10} {:>6} walkers  {:.3}/{:.3}  {}",
            conditions.fold,
            conditions.protocol.name(),
            conditions.window_rule.to_string(),
            scores.pedestrians,
            scores.min_ade,
            scores.min_fde,
            conditions.label()
        )?;
    }
    Ok(())
}
