//! Results by kind of motion.

use crate::document::{Part, Table};
use crate::report::cells::{counts, or_nothing};
use crate::report::group::{ResultGroup, TableLine};
use ddl_eval::{CategoryScores, MotionKind};
use std::fmt;

/// One table with a line for each kind of motion and a column for each forecaster. Empty if no row has scores by kind,
/// or if the forecasters share no fold.
pub(super) fn parts(group: &ResultGroup<'_>) -> Vec<Part> {
    let lines: Vec<(&TableLine<'_>, String)> = group
        .labelled()
        .filter(|(line, _)| {
            let mut rows = line.rows.iter();
            rows.all(|row| !row.scores.categories.is_empty())
        })
        .collect();
    let mut folds = group.folds();
    for (line, _) in &lines {
        folds = line.present(&folds);
    }
    if lines.is_empty() || folds.is_empty() {
        return Vec::new();
    }
    let columns = ["motion", "pedestrians"].map(str::to_owned).into_iter();
    let mut table = Table::new(columns.chain(lines.iter().map(|(_, label)| label.clone())));
    for kind in MotionKind::ALL {
        let cells: Vec<Option<Pooled>> = lines.iter().map(|(line, _)| Pooled::of(line, &folds, kind)).collect();
        if cells.iter().all(Option::is_none) {
            continue;
        }
        let pedestrians = cells.iter().flatten().map(|cell| cell.pedestrians);
        let start = [kind.to_string(), counts(pedestrians.collect())];
        table.row(start.into_iter().chain(cells.into_iter().map(or_nothing)));
    }
    vec![
        Part::subheading("By kind of motion"),
        Part::Table(table.captioned(format!(
            "{} in metres by kind of motion, pooled over {}. {}",
            group.errors(),
            folds.join(", "),
            group.conditions_in_words()
        ))),
    ]
}

struct Pooled {
    pedestrians: usize,
    errors: [f64; 2],
}

impl Pooled {
    /// Seeds are averaged on each fold first; `None` without pedestrians of the kind.
    fn of(line: &TableLine<'_>, folds: &[&str], kind: MotionKind) -> Option<Self> {
        let protocol = line.conditions().protocol;
        let (mut pedestrians, mut sums) = (0, [0.0; 2]);
        for fold in folds {
            let of_seeds: Vec<(usize, [f64; 2])> = line
                .on(fold)
                .flat_map(|row| &row.scores.categories)
                .filter(|scores| scores.category == kind)
                .filter_map(|scores: &CategoryScores| Some((scores.pedestrians, scores.errors(protocol)?)))
                .collect();
            // Every seed is scored on the same windows.
            let Some(&(first, _)) = of_seeds.first() else { continue };
            let weight = first as f64 / of_seeds.len() as f64;
            pedestrians += first;
            for (at, sum) in sums.iter_mut().enumerate() {
                *sum += weight * of_seeds.iter().map(|(_, errors)| errors[at]).sum::<f64>();
            }
        }
        (pedestrians > 0).then(|| Self { pedestrians, errors: sums.map(|sum| sum / pedestrians as f64) })
    }
}

impl fmt::Display for Pooled {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [ade, fde] = self.errors;
        write!(f, "{ade:.3}/{fde:.3}")
    }
}
