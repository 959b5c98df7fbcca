//! Intervals of the errors, and of the differences between lines.

use crate::document::{Part, Table};
use crate::report::cells::{self, NOTHING, or_nothing};
use crate::report::group::{ResultGroup, TableLine};
use ddl_eval::significance::{BlockErrors, Interval, mean_interval, paired_difference};
use rayon::prelude::*;

type BlockMetric = fn(&BlockErrors) -> f64;

/// The errors of the protocol, summed over a block.
const METRICS: [BlockMetric; 2] = [|block| block.min_ade, |block| block.min_fde];

/// Intervals of every line that has errors by block, and its difference from a reference line: the first trained line
/// with the most folds.
pub(super) fn parts(group: &ResultGroup<'_>) -> Vec<Part> {
    let folds = group.folds();
    let lines: Vec<(MeasuredLine<'_>, String)> =
        group.labelled().filter_map(|(line, label)| Some((MeasuredLine::of(line, &folds)?, label))).collect();
    let most = lines.iter().map(|(m, _)| m.folds.len()).max();
    let mut candidates = lines.iter().filter(|(m, _)| Some(m.folds.len()) == most);
    let first = candidates.clone().next();
    let trained = candidates.find(|(m, _)| m.line.conditions().epochs.is_some());
    let Some((reference, name)) = trained.or(first) else { return Vec::new() };
    let [ade, fde] = group.protocol.errors();
    let mut table = Table::new([
        "forecaster".to_owned(),
        "folds".to_owned(),
        format!("{ade} m"),
        format!("{fde} m"),
        format!("{ade} - {name} m"),
        "p".to_owned(),
        format!("{fde} - {name} m"),
        "p".to_owned(),
    ])
    .text_column("folds");
    let rows: Vec<Vec<String>> = lines
        .par_iter()
        .map(|(measured, label)| {
            let mut cells = vec![label.clone(), cells::folds(&measured.names(), &folds)];
            cells.extend(measured.intervals());
            for metric in METRICS {
                let difference = difference(measured, reference, metric);
                cells.extend(difference.unwrap_or([NOTHING; 2].map(str::to_owned)));
            }
            cells
        })
        .collect();
    for row in rows {
        table.row(row);
    }
    vec![
        Part::subheading("How sure the means are"),
        Part::Table(table.captioned(format!("95 % intervals and paired differences. {}", group.conditions_in_words()))),
    ]
}

/// The mean errors of a line over its folds, each with its 95 % interval.
pub(super) fn intervals(line: &TableLine<'_>, folds: &[&str]) -> [String; 2] {
    let measured = MeasuredLine::of(line, folds);
    measured.map_or([NOTHING; 2].map(str::to_owned), |line| line.intervals())
}

struct MeasuredLine<'a> {
    line: &'a TableLine<'a>,
    /// The measured folds, each with its blocks.
    folds: Vec<(String, Vec<BlockErrors>)>,
}

impl<'a> MeasuredLine<'a> {
    /// `None` if a row has no errors by block.
    fn of(line: &'a TableLine<'a>, folds: &[&str]) -> Option<Self> {
        let folds = line.present(folds).into_iter().map(|fold| Some((fold.to_owned(), line.blocks(fold)?)));
        let folds = folds.collect::<Option<Vec<_>>>().filter(|folds| !folds.is_empty())?;
        Some(Self { line, folds })
    }

    fn slices(&self) -> Vec<&[BlockErrors]> {
        self.folds.iter().map(|(_, blocks)| &blocks[..]).collect()
    }

    fn intervals(&self) -> [String; 2] {
        METRICS.map(|metric| or_nothing(mean_interval(&self.slices(), metric).map(in_words)))
    }

    fn names(&self) -> Vec<&str> {
        self.folds.iter().map(|(name, _)| name.as_str()).collect()
    }
}

/// The difference and its p-value; `None` if folds or windows differ, or if the lines are the same.
fn difference(measured: &MeasuredLine<'_>, reference: &MeasuredLine<'_>, metric: BlockMetric) -> Option<[String; 2]> {
    if std::ptr::eq(measured.line, reference.line) || measured.names() != reference.names() {
        return None;
    }
    let pair = paired_difference(&measured.slices(), &reference.slices(), metric)?;
    let p = match pair.p_value {
        small if small < 1e-3 => "<0.001".to_owned(),
        p => format!("{p:.3}"),
    };
    let Interval { mean, low, high } = pair.difference;
    let [mean, low, high] = [mean, low, high].map(signed);
    Some([format!("{mean} [{low}, {high}]"), p])
}

/// With its sign, unless it rounds to 0.
fn signed(metres: f64) -> String {
    let text = format!("{metres:+.3}");
    match text.as_str() {
        "+0.000" | "-0.000" => "0.000".to_owned(),
        _ => text,
    }
}

fn in_words(interval: Interval) -> String {
    let Interval { mean, low, high } = interval;
    format!("{mean:.3} [{low:.3}, {high:.3}]")
}
