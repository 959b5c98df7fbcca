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
pub(super) const LEGEND: &str = "By category of walker: minADE/minFDE in metres, mean over the walkers of the folds named, which all \
    forecasters of the table have (not over the folds: some hold few walkers of a kind). First the walker's own motion, then the \
    types of TrajNet++ (static, linear, interacting, non-interacting), then the kinds of interaction, of which a walker may have \
    several. Categories are told with the true future, after the forecasts are made.";

/// One table with a line a category and a column a forecaster; nothing where no row knows its categories, or no fold is shared.
pub(super) fn parts(group: &Group<'_>) -> Vec<Part> {
    let known: Vec<(&Line<'_>, String)> = group
        .lines
        .iter()
        .zip(group.labels())
        .filter(|(line, _)| {
            let mut rows = line.rows.iter();
            rows.all(|row| !row.scores.categories.is_empty())
        })
        .collect();
    let mut folds = group.folds();
    for (line, _) in &known {
        folds = line.present(&folds);
    }
    if known.is_empty() || folds.is_empty() {
        return Vec::new();
    }
    let columns = ["category", "walkers"].map(str::to_owned).into_iter();
    let mut table = Table::new(columns.chain(known.iter().map(|(_, label)| label.clone())));
    for category in Category::all() {
        let cells: Vec<Option<Pooled>> = known
            .iter()
            .map(|(line, _)| Pooled::of(line, &folds, category))
            .collect();
        let mut counts: Vec<usize> = cells.iter().flatten().map(|cell| cell.walkers).collect();
        counts.sort_unstable();
        counts.dedup();
        if counts.is_empty() {
            continue;
        }
        let counts: Vec<String> = counts.iter().map(usize::to_string).collect();
        let start = [category.to_string(), counts.join(" or ")];
        let cells = cells
            .into_iter()
            .map(|cell| cell.map_or(NOTHING.to_owned(), |cell| cell.in_words()));
        table.row(start.into_iter().chain(cells));
    }
    vec![
        Part::subheading("By category of walker"),
        Part::Table(table.captioned(format!(
            "minADE/minFDE in metres by category of walker, pooled over {}. {}",
            folds.join(", "),
            group.conditions_in_words()
        ))),
    ]
}

/// The walkers of one category on some folds together.
struct Pooled {
    walkers: usize,
    min_ade: f64,
    min_fde: f64,
}

impl Pooled {
    /// Seeds are averaged on each fold first; `None` where nobody is of the category.
    fn of(line: &Line<'_>, folds: &[&str], category: Category) -> Option<Self> {
        let (mut walkers, mut ade, mut fde) = (0, 0.0, 0.0);
        for fold in folds {
            let of_seeds: Vec<&CategoryScores> = line
                .on(fold)
                .flat_map(|row| &row.scores.categories)
                .filter(|scores| scores.category == category)
                .collect();
            // Every seed is scored on the same windows.
            let Some(first) = of_seeds.first() else {
                continue;
            };
            let weight = first.pedestrians as f64 / of_seeds.len() as f64;
            walkers += first.pedestrians;
            ade += weight * of_seeds.iter().map(|s| s.min_ade).sum::<f64>();
            fde += weight * of_seeds.iter().map(|s| s.min_fde).sum::<f64>();
        }
        (walkers > 0).then(|| Self {
            walkers,
            min_ade: ade / walkers as f64,
            min_fde: fde / walkers as f64,
        })
    }

    fn in_words(&self) -> String {
        format!("{:.3}/{:.3}", self.min_ade, self.min_fde)
    }
}
