//! The ranking at the head of the page: comparable rows, and the best of them.

use crate::report::{Report, ResultGroup, TableLine, groups, order};
use ddl_data::WindowRule;
use ddl_eval::{Conditions, Scores};

#[derive(Debug, Clone, PartialEq)]
pub(super) struct Standing {
    /// The conditions that all lines share; fold and forecaster are those of one row.
    pub(super) shared: Conditions,
    pub(super) in_words: String,
    pub(super) folds: Vec<String>,
    pub(super) all_folds: bool,
    pub(super) lines: Vec<StandingLine>,
}

#[derive(Debug, Clone, PartialEq)]
pub(super) struct StandingLine {
    pub(super) label: String,
    pub(super) conditions: Conditions,
    pub(super) settings: String,
    pub(super) hypotheses: usize,
    /// The errors of the protocol on each fold, m, mean over seeds; `None` where it was not measured.
    pub(super) folds: Vec<Option<[f64; 2]>>,
    /// Unweighted mean of the folds; `None` unless all were measured.
    pub(super) mean: Option<[f64; 2]>,
    /// Pedestrians and windows scored, each fold once.
    pub(super) scored: [usize; 2],
}

impl Standing {
    /// The forecaster that is the subject of the report: the best trained one, without its variations ("DDL", not "DDL
    /// as packed"). If there is no trained one, it is that of another program, otherwise the best one.
    pub(super) fn subject(&self) -> Option<&StandingLine> {
        let trained = |line: &&StandingLine| line.conditions.epochs.is_some();
        let foreign = |line: &&StandingLine| line.conditions.selection.is_some();
        let lines = || self.lines.iter();
        let name = |line: &StandingLine| line.conditions.forecaster.clone();
        let best = lines().find(trained).map(name).unwrap_or_default();
        lines()
            .filter(trained)
            .filter(|line| best.starts_with(&line.conditions.forecaster))
            .min_by_key(|line| line.conditions.forecaster.len())
            .or_else(|| lines().find(foreign))
            .or(self.lines.first())
    }

    /// The forecasters that `line` can be ranked against, the best first: those with the same number of hypotheses and
    /// with every fold measured, without its own variations.
    pub(super) fn others<'a>(&'a self, line: &'a StandingLine) -> impl Iterator<Item = &'a StandingLine> {
        let is_other = |other: &&StandingLine| {
            let is_variation = std::ptr::eq(*other, line)
                || line.conditions.epochs.is_some()
                    && other.conditions.forecaster.starts_with(&line.conditions.forecaster);
            other.mean.is_some() && other.hypotheses == line.hypotheses && !is_variation
        };
        self.lines.iter().filter(is_other)
    }
}

/// The results that the page begins with: those under `fair`, otherwise `single`, otherwise `published`; among them
/// those of the published window rule on all test windows, if there are any.
pub(super) fn standing(report: &Report) -> Option<Standing> {
    let groups = groups(report.rows());
    // Groups are sorted by convention and rule; of equal ones, the first is taken.
    let rank = |group: &&ResultGroup<'_>| {
        let other_rule = group.window_rule != WindowRule::Published;
        (order(group.protocol), group.convention, other_rule)
    };
    let group = groups.iter().min_by_key(rank)?;
    let measured = |fold: &&str| !group.pedestrians(fold).is_empty();
    let folds: Vec<&str> = group.folds().into_iter().filter(measured).collect();
    let mut lines: Vec<_> = group.labelled().map(|(line, label)| StandingLine::of(line, label, &folds)).collect();
    // Lines without a mean come last; the sort is stable.
    let order = |line: &StandingLine| line.mean.map_or(f64::INFINITY, |mean| mean[0]);
    lines.sort_by(|a, b| order(a).total_cmp(&order(b)));
    Some(Standing {
        shared: group.lines.first()?.conditions().clone(),
        in_words: group.conditions_in_words(),
        all_folds: group.convention.fold_names().all(|name| folds.contains(&name)),
        folds: folds.into_iter().map(str::to_owned).collect(),
        lines,
    })
}

impl StandingLine {
    fn of(line: &TableLine<'_>, label: String, folds: &[&str]) -> Self {
        let protocol = line.conditions().protocol;
        let pair = |mean: &dyn Fn(usize) -> Option<f64>| Some([mean(0)?, mean(1)?]);
        let on_fold = |fold: &&str| pair(&|at| Some(line.on_fold(fold, |s| Some(s.errors(protocol)[at]))?.mean));
        let count = |number: fn(&Scores) -> usize| -> usize {
            folds.iter().filter_map(|fold| line.on(fold).next()).map(|row| number(&row.scores)).sum()
        };
        Self {
            label,
            conditions: line.conditions().clone(),
            settings: line.settings(),
            hypotheses: line.rows[0].scores.hypotheses,
            folds: folds.iter().map(on_fold).collect(),
            mean: pair(&|at| Some(line.over_folds(folds, |s| Some(s.errors(protocol)[at]))?.mean)),
            scored: [count(|s| s.pedestrians), count(|s| s.windows)],
        }
    }
}
