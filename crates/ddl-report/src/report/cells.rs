//! Cells of the tables.

use crate::report::group::TableLine;
use crate::report::spread::SeedSpread;

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

/// The two errors of the protocol of a line on each fold, then their mean.
pub(super) fn errors(line: &TableLine<'_>, folds: &[&str]) -> Vec<String> {
    errors_as(line, folds, |spread| spread.to_string())
}

/// As [`errors`], with these words of a fold.
pub(super) fn errors_as(line: &TableLine<'_>, folds: &[&str], words: fn(SeedSpread) -> String) -> Vec<String> {
    let protocol = line.conditions().protocol;
    let of_fold = |fold: &&str| {
        let error = |at: usize| line.on_fold(fold, |s| Some(s.errors(protocol)[at])).map(words);
        pair(error(0), error(1))
    };
    let mean = |at: usize| line.over_folds(folds, |s| Some(s.errors(protocol)[at]));
    folds.iter().map(of_fold).chain([pair(mean(0), mean(1))]).collect()
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
    if present.len() == folds.len() { "all".to_owned() } else { present.join(", ") }
}
