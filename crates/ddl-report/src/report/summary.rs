//! The main tables of a benchmark, `summary.md`: the rows and columns of a report that count most.

use crate::document::Table;
use crate::literature;
use crate::report::cells::{counts, errors, errors_as};
use crate::report::group::{ResultGroup, groups};
use crate::report::{deployable, metrics, significance};
use ddl_data::Convention;
use ddl_eval::{Protocol, ResultRow};

/// Rows that only the full tables show, by the end of their names.
const LEFT_OUT: [&str; 3] = ["as packed", "on the way that its network shapes", "constant acceleration (bounded)"];

/// Columns of the table of scenes, by their names in the full tables.
const COLLISIONS: [&str; 3] = ["of all futures %", "of the best %", "of the true one %"];

/// Columns of the second table, by their names in the full tables.
const METRICS: [&str; 7] = ["goal FDE m", "missed %", "collide %", "certified %", "KDE NLL nats", "AMD", "AMV m²"];

pub(super) fn in_words(rows: &[ResultRow], convention: Convention) -> Option<String> {
    let groups = groups(rows);
    let is_headline =
        |group: &ResultGroup<'_>| group.convention == convention && group.window_rule == convention.headline_rule();
    let shown: Vec<&ResultGroup<'_>> = groups
        .iter()
        .filter(|group| is_headline(group) && ![Protocol::Published, Protocol::Joint].contains(&group.protocol))
        .collect();
    let folds = shown.first()?.folds();
    let columns = [&["forecaster", "protocol"], &folds[..], &["mean"]].concat();
    let mut by_fold = Table::new(columns).text_column("protocol");
    let columns = [&["forecaster", "protocol", "minADE m", "minFDE m"][..], &METRICS].concat();
    let mut others = Table::new(columns).text_column("protocol");

    let pedestrians = folds.iter().map(|fold| counts(shown[0].pedestrians(fold)));
    let start = ["pedestrians scored".to_owned(), String::new()];
    by_fold.row(start.into_iter().chain(pedestrians));
    let mut seen = Vec::new();
    for group in &shown {
        for (line, label) in group.labelled() {
            // The deviation of each fold would double the width of the table.
            let cells = errors_as(line, &folds, |spread| format!("{:.3}", spread.mean));
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
            by_fold.row(start.into_iter().chain(cells));
        }
    }
    // A part of the windows or of the folds does not compare with what others measured on all.
    let is_whole = shown[0].test_subset.is_none() && convention.fold_names().all(|name| folds.contains(&name));
    if let Some(best) = literature::best(convention).filter(|_| is_whole) {
        let start = [format!("{}, the best published", best.method), "best of 20".to_owned()];
        let published = |fold: &&str| {
            let index = convention.fold_names().position(|name| name == *fold);
            index.and_then(|index| best.folds.get(index))
        };
        let cells = folds.iter().filter_map(published).chain([&best.mean]);
        let cells = cells.map(|[ade, fde]| format!("{ade:.2}/{fde:.2}"));
        by_fold.row(start.into_iter().chain(cells));
    }
    let fair = shown.iter().find(|group| group.protocol == Protocol::Fair);
    let deployable = fair.and_then(|fair| deployable::table(fair, &groups));
    let deployable = deployable.map_or(String::new(), |table| {
        format!("\nOne path without the truth, ADE/FDE in metres (CVaR95 of the ADE):\n\n{table:#}")
    });
    let mut groups = groups.iter();
    let scenes = groups.find(|group| is_headline(group) && group.protocol == Protocol::Joint);
    let scenes = scenes.map_or(String::new(), of_scenes);
    Some(format!(
        "minADE/minFDE in metres:\n\n{by_fold:#}\nMean over the folds, with 95 % intervals:\n\n{others:#}{deployable}\
         {scenes}"
    ))
}

/// The futures of whole scenes.
fn of_scenes(group: &ResultGroup<'_>) -> String {
    let folds = group.folds();
    let end = [&["mean"][..], &COLLISIONS].concat();
    let mut table = Table::of_folds(&["forecaster"], &folds, &end);
    for (line, label) in group.labelled() {
        let present = line.present(&folds);
        let collisions = COLLISIONS.map(|name| metrics::mean(line, &present, name));
        table.row([label].into_iter().chain(errors(line, &folds)).chain(collisions));
    }
    format!("\nFutures of whole scenes, {} in metres:\n\n{table:#}", group.errors())
}
