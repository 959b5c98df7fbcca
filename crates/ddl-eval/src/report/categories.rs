//! Results by kind of motion and of interaction.

use super::{
    group::{Group, Line},
    section::NOTHING,
};
use crate::{
    CategoryScores,
    category::Category,
    document::{Part, Table},
};

/// What the categories are.
pub(super) const LEGEND: &str = "By category of walker: minADE/minFDE in metres, mean over the walkers of all folds that the forecaster was \
    scored on (not over the folds: some hold few walkers of a kind). First the walker's own motion, then the types of TrajNet++ \
    (static, linear, interacting, non-interacting), then the kinds of interaction, of which a walker may have several. Categories \
    are told with the true future, after the forecasts are made.";

/// One table with a line a category and a column a forecaster; nothing where no row knows its categories.
pub(super) fn parts(group: &Group<'_>) -> Vec<Part> {
    let known: Vec<(&Line<'_>, String)> = group
        .lines
        .iter()
        .zip(group.labels())
        .filter(|(line, _)| {
            line.rows
                .iter()
                .all(|row| !row.scores.categories.is_empty())
        })
        .collect();
    if known.is_empty() {
        return Vec::new();
    }
    let columns = ["category", "walkers"].map(str::to_owned).into_iter();
    let mut table = Table::new(columns.chain(known.iter().map(|(_, label)| label.clone())));
    for category in Category::all() {
        let cells: Vec<Option<(usize, String)>> = known
            .iter()
            .map(|(line, _)| over_walkers(line, category))
            .collect();
        let mut counts: Vec<usize> = cells.iter().flatten().map(|(count, _)| *count).collect();
        counts.sort_unstable();
        counts.dedup();
        if counts.is_empty() {
            continue;
        }
        let counts: Vec<String> = counts.iter().map(usize::to_string).collect();
        let start = [category.to_string(), counts.join(" or ")];
        let cells = cells
            .into_iter()
            .map(|cell| cell.map_or(NOTHING.to_owned(), |(_, text)| text));
        table.row(start.into_iter().chain(cells));
    }
    vec![
        Part::subheading("By category of walker"),
        Part::Table(table.captioned(format!(
            "minADE/minFDE in metres by category of walker, pooled over folds. {}",
            group.conditions_in_words()
        ))),
    ]
}

/// Walkers of a category a seed, and their errors over all folds and seeds; `None` where nobody is in it.
fn over_walkers(line: &Line<'_>, category: Category) -> Option<(usize, String)> {
    let of: Vec<&CategoryScores> = line
        .rows
        .iter()
        .flat_map(|row| &row.scores.categories)
        .filter(|scores| scores.category == category)
        .collect();
    let walkers: usize = of.iter().map(|scores| scores.pedestrians).sum();
    if walkers == 0 {
        return None;
    }
    let mean = |error: fn(&CategoryScores) -> f64| {
        let sum: f64 = of.iter().map(|s| error(s) * s.pedestrians as f64).sum();
        sum / walkers as f64
    };
    let text = format!("{:.3}/{:.3}", mean(|s| s.min_ade), mean(|s| s.min_fde));
    // Every seed is scored on the same windows.
    Some((walkers / line.seeds().len().max(1), text))
}
