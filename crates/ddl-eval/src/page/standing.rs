//! The comparison at the head of the page: rows that may be compared, and which of them is best.

use ddl_data::{Convention, WindowRule};

use crate::{Conditions, Protocol, Report, ResultRow, Scores};

/// Comparable lines of a report: one convention, window rule, protocol and scored part.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Standing {
    /// What all lines share; fold and forecaster are those of one row.
    pub(super) shared: Conditions,
    /// The folds measured, in the order of the convention.
    pub(super) folds: Vec<String>,
    /// Whether these are all folds of the convention.
    pub(super) all_folds: bool,
    /// Lines, the best first.
    pub(super) lines: Vec<StandingLine>,
}

/// One forecaster in a [`Standing`].
#[derive(Debug, Clone, PartialEq)]
pub(super) struct StandingLine {
    /// Its name, numbered as in the tables where names repeat.
    pub(super) label: String,
    /// Conditions of its first row.
    pub(super) conditions: Conditions,
    /// Its seeds.
    pub(super) seeds: Vec<u64>,
    /// Hypotheses a walker.
    pub(super) hypotheses: usize,
    /// minADE and minFDE on each fold, m, mean over seeds; `None` where it was not measured.
    pub(super) folds: Vec<Option<[f64; 2]>>,
    /// Plain mean of the folds, `None` unless all are there.
    pub(super) mean: Option<[f64; 2]>,
    /// Walkers and windows scored, each fold once.
    pub(super) scored: [usize; 2],
}

/// The results that the page begins with: under `fair` if there are any, else `single`, else `published`; of these, those
/// by the published window rule on all test windows if there are any.
pub(super) fn standing(report: &Report) -> Option<Standing> {
    let place = |c: &Conditions| {
        let convention = Convention::ALL
            .iter()
            .position(|known| *known == c.convention);
        let protocol = match c.protocol {
            Protocol::Fair => 0,
            Protocol::Single => 1,
            Protocol::Published => 2,
        };
        let rule = (
            c.window_rule != WindowRule::Published,
            c.window_rule.to_string(),
        );
        (protocol, convention, rule, c.test_subset.clone())
    };
    let first = report
        .rows()
        .iter()
        .min_by_key(|row| place(&row.conditions))?;
    let shared = first.conditions.clone();
    let rows: Vec<&ResultRow> = report
        .rows()
        .iter()
        .filter(|row| place(&row.conditions) == place(&shared))
        .collect();

    let named: Vec<&str> = shared.convention.fold_names().collect();
    let mut folds: Vec<String> = named.iter().map(ToString::to_string).collect();
    folds.extend(rows.iter().map(|row| row.conditions.fold.clone()));
    let mut seen: Vec<String> = Vec::new();
    folds.retain(|fold| {
        let new = !seen.contains(fold) && rows.iter().any(|row| row.conditions.fold == *fold);
        seen.push(fold.clone());
        new
    });
    let all_folds = named
        .iter()
        .all(|name| folds.iter().any(|fold| fold == name));

    let mut lines: Vec<Vec<&ResultRow>> = Vec::new();
    for row in rows {
        match lines.iter_mut().find(|line| alike(line[0], row)) {
            Some(line) => line.push(row),
            None => lines.push(vec![row]),
        }
    }
    let labels = labels(&lines);
    let mut lines: Vec<StandingLine> = lines
        .iter()
        .zip(labels)
        .map(|(rows, label)| StandingLine::of(rows, label, &folds))
        .collect();
    // Lines without a mean stand last; the sort is stable.
    let order = |line: &StandingLine| line.mean.map_or(f64::INFINITY, |mean| mean[0]);
    lines.sort_by(|a, b| order(a).total_cmp(&order(b)));
    Some(Standing {
        shared,
        folds,
        all_folds,
        lines,
    })
}

/// Whether two rows differ in fold and seed alone.
fn alike(a: &ResultRow, b: &ResultRow) -> bool {
    let same = Conditions {
        fold: a.conditions.fold.clone(),
        seed: a.conditions.seed,
        ..b.conditions.clone()
    };
    a.conditions == same
}

fn labels(lines: &[Vec<&ResultRow>]) -> Vec<String> {
    let plain: Vec<String> = lines
        .iter()
        .map(|line| line[0].conditions.label())
        .collect();
    let numbered = |(at, label): (usize, &String)| {
        let same = plain.iter().filter(|other| *other == label).count();
        let before = plain[..at].iter().filter(|other| *other == label).count();
        if same > 1 {
            format!("{label} #{}", before + 1)
        } else {
            label.clone()
        }
    };
    plain.iter().enumerate().map(numbered).collect()
}

impl StandingLine {
    fn of(rows: &[&ResultRow], label: String, folds: &[String]) -> Self {
        let mut seeds: Vec<Option<u64>> = rows.iter().map(|row| row.conditions.seed).collect();
        seeds.sort_unstable();
        seeds.dedup();
        let pair = |of: fn(&Scores) -> f64, fold: &String| {
            mean(of_fold(rows, fold).map(|row| of(&row.scores)))
        };
        let both = |fold: &String| Some([pair(|s| s.min_ade, fold)?, pair(|s| s.min_fde, fold)?]);
        // The mean over folds is taken seed by seed, as the tables take it.
        let of_seed = |of: fn(&Scores) -> f64, seed: &Option<u64>| {
            let values: Option<Vec<f64>> = folds
                .iter()
                .map(|fold| {
                    Some(of(&of_fold(rows, fold)
                        .find(|row| row.conditions.seed == *seed)?
                        .scores))
                })
                .collect();
            mean(values?.into_iter())
        };
        let over_seeds = |of: fn(&Scores) -> f64| {
            let means: Option<Vec<f64>> = seeds.iter().map(|seed| of_seed(of, seed)).collect();
            mean(means?.into_iter())
        };
        let whole = over_seeds(|s| s.min_ade).zip(over_seeds(|s| s.min_fde));
        let count = |of: fn(&Scores) -> usize| -> usize {
            let first = folds.iter().filter_map(|fold| of_fold(rows, fold).next());
            first.map(|row| of(&row.scores)).sum()
        };
        Self {
            label,
            conditions: rows[0].conditions.clone(),
            seeds: seeds.iter().flatten().copied().collect(),
            hypotheses: rows[0].scores.hypotheses,
            folds: folds.iter().map(both).collect(),
            mean: whole.map(|(ade, fde)| [ade, fde]),
            scored: [count(|s| s.pedestrians), count(|s| s.windows)],
        }
    }
}

fn of_fold<'a>(rows: &'a [&'a ResultRow], fold: &'a str) -> impl Iterator<Item = &'a ResultRow> {
    rows.iter()
        .copied()
        .filter(move |row| row.conditions.fold == fold)
}

/// `None` of nothing. Summed in order, as the tables do.
fn mean(values: impl Iterator<Item = f64>) -> Option<f64> {
    let values: Vec<f64> = values.collect();
    (!values.is_empty()).then(|| values.iter().sum::<f64>() / values.len() as f64)
}
