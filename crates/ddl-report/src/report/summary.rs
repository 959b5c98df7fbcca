//! The main tables of a benchmark, `summary.md`: the rows and columns of a report that count most.

use ddl_data::Convention;
use ddl_eval::{Protocol, ResultRow};

use crate::document::Table;
use crate::literature;
use crate::report::cells::{counts, pair};
use crate::report::group::{ResultGroup, TableLine, groups};
use crate::report::spread::SeedSpread;
use crate::report::{deployable, metrics, significance};

/// Rows that only the full tables show, by the end of their names.
const LEFT_OUT: [&str; 3] = [
    "without an expert library",
    "on the way that its network shapes",
    "constant acceleration (bounded)",
];

/// Columns of the second table, by their names in the full tables.
const METRICS: [&str; 7] = [
    "goal FDE m",
    "missed %",
    "collide %",
    "certified %",
    "KDE NLL nats",
    "AMD",
    "AMV m²",
];

pub(super) fn of(rows: &[ResultRow], convention: Convention) -> Option<String> {
    let groups = groups(rows);
    let shown: Vec<&ResultGroup<'_>> = groups
        .iter()
        .filter(|group| {
            group.convention == convention
                && group.window_rule == convention.headline_rule()
                && group.protocol != Protocol::Published
        })
        .collect();
    let folds = shown.first()?.folds();
    let columns = [&["forecaster", "protocol"], &folds[..], &["mean"]].concat();
    let mut errors = Table::new(columns).text_column("protocol");
    let columns = [&["forecaster", "protocol", "minADE m", "minFDE m"][..], &METRICS].concat();
    let mut others = Table::new(columns).text_column("protocol");

    let pedestrians = folds.iter().map(|fold| counts(shown[0].pedestrians(fold)));
    let start = ["pedestrians scored".to_owned(), String::new()];
    errors.row(start.into_iter().chain(pedestrians));
    let mut seen = Vec::new();
    for group in &shown {
        for (line, label) in group.labelled() {
            let cells = error_cells(line, &folds);
            let row = (label, cells);
            if seen.contains(&row) || LEFT_OUT.iter().any(|name| row.0.ends_with(name)) {
                continue;
            }
            seen.push(row.clone());
            let (label, cells) = row;
            let start = [label, group.protocol.to_string()];
            let intervals = significance::intervals(line, &folds);
            let present = line.present(&folds);
            let means = METRICS.map(|name| metrics::mean(line, &present, name));
            others.row(start.iter().cloned().chain(intervals).chain(means));
            errors.row(start.into_iter().chain(cells));
        }
    }
    if let Some(best) = literature::best(convention) {
        let start = [format!("{}, the best published", best.method), "best of 20".to_owned()];
        let published = |fold: &&str| {
            let index = convention.fold_names().position(|name| name == *fold);
            index.and_then(|index| best.folds.get(index))
        };
        let cells = folds.iter().filter_map(published).chain([&best.mean]);
        let cells = cells.map(|[ade, fde]| format!("{ade:.2}/{fde:.2}"));
        errors.row(start.into_iter().chain(cells));
    }
    let fair = shown.iter().find(|group| group.protocol == Protocol::Fair);
    let deployable = fair.and_then(|fair| deployable::table(fair, &groups));
    let deployable = deployable.map_or(String::new(), |table| {
        format!("\nOne path without the truth, ADE/FDE in metres (CVaR95 of the ADE):\n\n{table:#}")
    });
    Some(format!(
        "minADE/minFDE in metres:\n\n{errors:#}\nMean over the folds, with 95 % intervals:\n\n{others:#}{deployable}"
    ))
}

/// minADE/minFDE of each fold without their deviation, which would double the width of the table, then their mean with
/// it.
fn error_cells(line: &TableLine<'_>, folds: &[&str]) -> Vec<String> {
    let rounded = |spread: SeedSpread| format!("{:.3}", spread.mean);
    let mut cells = Vec::new();
    for fold in folds {
        let ade = line.on_fold(fold, |s| s.min_ade).map(rounded);
        let fde = line.on_fold(fold, |s| s.min_fde).map(rounded);
        cells.push(pair(ade, fde));
    }
    let ade = line.over_folds(folds, |s| s.min_ade);
    cells.push(pair(ade, line.over_folds(folds, |s| s.min_fde)));
    cells
}
