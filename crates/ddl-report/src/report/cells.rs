//! Cells of the tables.

use crate::report::group::TableLine;

pub(super) const NOTHING: &str = "-";

pub(super) fn or_nothing<T: std::fmt::Display>(value: Option<T>) -> String {
    value.map_or(NOTHING.to_owned(), |value| value.to_string())
}

/// `ADE/FDE`, if both are known.
pub(super) fn pair<T: std::fmt::Display>(ade: Option<T>, fde: Option<T>) -> String {
    match (ade, fde) {
        (Some(ade), Some(fde)) => format!("{ade}/{fde}"),
        _ => NOTHING.to_owned(),
    }
}

/// minADE/minFDE of a line on each fold, then their mean.
pub(super) fn errors(line: &TableLine<'_>, folds: &[&str]) -> Vec<String> {
    let of_fold = |fold: &&str| pair(line.on_fold(fold, |s| s.min_ade), line.on_fold(fold, |s| s.min_fde));
    let mean = pair(
        line.over_folds(folds, |s| s.min_ade),
        line.over_folds(folds, |s| s.min_fde),
    );
    folds.iter().map(of_fold).chain([mean]).collect()
}

pub(super) fn counts(mut counts: Vec<usize>) -> String {
    counts.sort_unstable();
    counts.dedup();
    if counts.is_empty() {
        return NOTHING.to_owned();
    }
    let counts: Vec<String> = counts.iter().map(usize::to_string).collect();
    counts.join(" or ")
}

/// Text that names the folds of a number.
pub(super) fn folds(present: &[&str], folds: &[&str]) -> String {
    if present.len() == folds.len() {
        "all".to_owned()
    } else {
        present.join(", ")
    }
}
