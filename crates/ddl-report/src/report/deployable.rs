//! What a program can use that takes one path for each pedestrian, chosen without the truth.

use crate::document::{Part, Table};
use crate::report::cells::NOTHING;
use crate::report::group::{ResultGroup, TableLine};
use ddl_eval::{DeployableErrors, Protocol, Scores};

const NOTE: &str = "One path for each pedestrian, chosen without the truth: the forecast of one hypothesis, or the \
    likeliest or the medoid of several. Cells: ADE/FDE in metres, in brackets the mean ADE of the worst 5 % of the \
    pedestrians (CVaR95); mean over seeds; last the plain mean of all folds.";

/// The choice of a path, and its errors.
type Choice = (&'static str, fn(&Scores) -> Option<DeployableErrors>);

const OF_SEVERAL: [Choice; 2] = [(", likeliest", |s| s.likeliest), (", medoid", |s| s.medoid)];

/// One table for the groups of `fair` and `single` with the same windows.
pub(super) fn parts(groups: &[ResultGroup<'_>]) -> Vec<Part> {
    let tables = groups.iter().filter(|group| group.protocol == Protocol::Fair);
    let part = |fair: &ResultGroup<'_>| {
        let title =
            format!("What can be deployed, window rule `{}`, convention `{}`", fair.window_rule, fair.convention);
        let table = table(fair, groups)?;
        let caption = format!(
            "{NOTE} Data convention `{}`, window rule `{}`, protocols `single` and `fair`; scored: {}.",
            fair.convention,
            fair.window_rule,
            fair.test_subset.unwrap_or("all test windows")
        );
        Some([Part::heading(title), Part::Table(table.captioned(caption))])
    };
    tables.filter_map(part).flatten().collect()
}

/// `None` for results of earlier versions.
pub(super) fn table(fair: &ResultGroup<'_>, groups: &[ResultGroup<'_>]) -> Option<Table> {
    let folds = fair.folds();
    let mut table = Table::of_folds(&["forecaster"], &folds, &["mean"]);
    let single = groups.iter().filter(|group| group.protocol == Protocol::Single && group.same_windows(fair));
    for (line, label) in single.flat_map(ResultGroup::labelled) {
        row(&mut table, label, line, &folds, OF_SEVERAL[0].1);
    }
    for (line, label) in fair.labelled().filter(|(line, _)| line.rows[0].scores.hypotheses > 1) {
        for (words, choice) in OF_SEVERAL {
            row(&mut table, format!("{label}{words}"), line, &folds, choice);
        }
    }
    (!table.rows.is_empty()).then_some(table)
}

fn row(
    table: &mut Table,
    label: String,
    line: &TableLine<'_>,
    folds: &[&str],
    choice: fn(&Scores) -> Option<DeployableErrors>,
) {
    let metrics = [
        |errors: DeployableErrors| errors.ade,
        |errors: DeployableErrors| errors.fde,
        |errors: DeployableErrors| errors.worst_ade,
    ];
    let cell = |value: &dyn Fn(fn(DeployableErrors) -> f64) -> Option<f64>| {
        let [ade, fde, worst] = metrics.map(value);
        Some(format!("{:.3}/{:.3} ({:.2})", ade?, fde?, worst?))
    };
    let of_fold = |fold: &&str| cell(&|metric| Some(line.on_fold(fold, |s| choice(s).map(metric))?.mean));
    let mean = cell(&|metric| Some(line.over_folds(folds, |s| choice(s).map(metric))?.mean));
    let cells: Vec<Option<String>> = folds.iter().map(of_fold).chain([mean]).collect();
    if cells.iter().any(Option::is_some) {
        let cells = cells.into_iter().map(|cell| cell.unwrap_or_else(|| NOTHING.to_owned()));
        table.row([label].into_iter().chain(cells));
    }
}
