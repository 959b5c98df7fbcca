//! Results as lines for a terminal.

use ddl::Protocol;
use ddl::data::Convention;
use ddl::eval::{RecordingErrors, ResultRow};
use ddl::report::Report;
use std::fmt::{Result, Write as _};

const VELOCITY: &str = "constant velocity (last step)";
/// A pedestrian counts once in every window.
const PEDESTRIAN_WINDOWS: &str = "pedestrian-windows";

/// One line for each result, under the conditions it shares with others; `rest` tells where to find the remaining
/// metrics.
pub(crate) fn lines(report: &Report, rest: &str) -> String {
    let mut text = String::new();
    // writing to a `String` cannot fail
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
            Protocol::Single | Protocol::OnlineSingle => ("ADE/FDE", "of one hypothesis"),
            Protocol::Joint => ("JADE/JFDE", "best of K futures of the scene"),
            _ => ("minADE/minFDE", "best of K"),
        };
        let of_table = || report.rows().iter().filter(|row| common(row) == common(first));
        let width = of_table().map(|row| row.conditions.fold.chars().count()).max().unwrap_or(0).max(10);
        let counted = match convention {
            Convention::Own => PEDESTRIAN_WINDOWS,
            _ => "pedestrians",
        };
        let counts = counted.len();
        writeln!(out, "\nconvention {convention}, protocol {protocol}, windows {rule}; {errors} in metres, {of}")?;
        // The subset is the same for all rows, because they were evaluated together.
        if let Some(subset) = &first.conditions.test_subset {
            writeln!(out, "{subset}")?;
        }
        writeln!(out, "{:width$} {counted} {:>3}  {errors:15}  forecaster", "fold", "K")?;
        for row in of_table() {
            let (conditions, scores) = (&row.conditions, &row.scores);
            writeln!(
                out,
                "{:width$} {:>counts$} {:>3}  {:15}  {}",
                conditions.fold,
                scores.pedestrians,
                scores.hypotheses,
                pair(scores.errors(protocol)),
                conditions.label()
            )?;
        }
        if first.conditions.convention == Convention::Own {
            let velocity = of_table().find(|row| row.conditions.forecaster == VELOCITY);
            write_recordings(out, first, velocity)?;
        }
    }
    writeln!(out, "\n{rest}")
}

fn pair([ade, fde]: [f64; 2]) -> String {
    format!("{ade:.3}/{fde:.3}")
}

/// One line for each recording, if several were evaluated together: errors of the first forecaster and of constant
/// velocity.
fn write_recordings(out: &mut String, first: &ResultRow, other: Option<&ResultRow>) -> Result {
    let recordings = first.by_recording();
    if recordings.len() < 2 {
        return Ok(());
    }
    let width = recordings.iter().map(|recording| recording.recording.chars().count()).max().unwrap_or(0).max(10);
    let label = first.conditions.label();
    let column = label.chars().count().max(15);
    let of_other = other.map(ResultRow::by_recording).unwrap_or_default();
    let counts = PEDESTRIAN_WINDOWS.len();
    let errors = |recording: &RecordingErrors| pair([recording.min_ade, recording.min_fde]);
    let beside = other.map_or("", |_| VELOCITY);
    writeln!(out, "\n{:width$} {:>counts$}  {label:column$}  {beside}", "recording", PEDESTRIAN_WINDOWS)?;
    for recording in &recordings {
        let same = of_other.iter().find(|other| other.recording == recording.recording);
        writeln!(
            out,
            "{:width$} {:>counts$}  {:column$}  {}",
            recording.recording,
            recording.pedestrians,
            errors(recording),
            same.map(errors).unwrap_or_default()
        )?;
    }
    Ok(())
}
