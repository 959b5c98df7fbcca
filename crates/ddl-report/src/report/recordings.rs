//! Errors by recording, for own recordings that were measured together.

use crate::document::{Part, Table};
use crate::report::cells::pair;
use crate::report::group::ResultGroup;
use ddl_data::Convention;
use ddl_eval::{RecordingErrors, ResultRow};

/// A table for each set of own recordings: a row for each recording and one for all, a column for each forecaster.
pub(super) fn parts(group: &ResultGroup<'_>) -> Vec<Part> {
    if group.convention != Convention::Own {
        return Vec::new();
    }
    let tables: Vec<Part> = group.folds().iter().filter_map(|fold| table(group, fold)).map(Part::Table).collect();
    if tables.is_empty() {
        return Vec::new();
    }
    [Part::subheading("By recording")].into_iter().chain(tables).collect()
}

/// `None` for a single recording.
fn table(group: &ResultGroup<'_>, fold: &str) -> Option<Table> {
    // The first of several seeds.
    let rows = group.lines.iter().map(|line| line.on(fold).next());
    let measured: Vec<(String, &ResultRow, Vec<RecordingErrors>)> = group
        .labels()
        .into_iter()
        .zip(rows)
        .filter_map(|(label, row)| Some((label, row?, row?.by_recording())))
        .collect();
    let (_, first, recordings) = measured.first()?;
    if recordings.len() < 2 {
        return None;
    }
    let columns = ["recording".to_owned(), "pedestrian-windows".to_owned()];
    let forecasters = measured.iter().map(|(label, ..)| label.clone());
    let mut table = Table::new(columns.into_iter().chain(forecasters));
    for RecordingErrors { recording, pedestrians, .. } in recordings {
        let errors = measured.iter().map(|(.., recordings)| {
            let same = recordings.iter().find(|same| same.recording == *recording);
            pair(same.map(|r| rounded(r.min_ade)), same.map(|r| rounded(r.min_fde)))
        });
        let start = [recording.clone(), pedestrians.to_string()];
        table.row(start.into_iter().chain(errors));
    }
    let errors = measured.iter().map(|(_, row, _)| row.scores.errors(group.protocol));
    let errors = errors.map(|[ade, fde]| pair(Some(rounded(ade)), Some(rounded(fde))));
    let start = ["all".to_owned(), first.scores.pedestrians.to_string()];
    table.row(start.into_iter().chain(errors));
    Some(table.captioned(format!(
        "{} in metres, mean over the pedestrians of each recording, and of all; of several seeds the first. {}",
        group.errors(),
        group.conditions_in_words()
    )))
}

fn rounded(metres: f64) -> String {
    format!("{metres:.3}")
}
