//! The effect of the memory of a recording over the time of observation: `online` forecasts beside those of the same
//! model without the memory.

use ddl_eval::Protocol;
use ddl_eval::significance::BlockErrors;

use crate::document::{Part, Table};
use crate::report::cells::or_nothing;
use crate::report::group::{ResultGroup, TableLine};

const QUARTERS: usize = 4;

const NOTE: &str = "By quarters of the time from the first to the last window of a recording. The brackets give the \
    change against the same model without the memory of the recording, on the same windows. The two numbers come from \
    different protocols: the change is the value of the memory of the recording, not an improvement of the method.";

/// One model on one recording, with and without the memory of the recording.
struct Watched {
    forecaster: String,
    /// Blocks of the recording, means over seeds.
    watching: Vec<BlockErrors>,
    alone: Vec<BlockErrors>,
}

impl Watched {
    fn recording(&self) -> &str {
        &self.watching[0].recording
    }
}

/// The models of an online group on each recording, if they were also scored without the memory.
fn watched(group: &ResultGroup<'_>, groups: &[ResultGroup<'_>]) -> Vec<Watched> {
    let without = match group.protocol {
        Protocol::Online => Protocol::Fair,
        Protocol::OnlineSingle => Protocol::Single,
        _ => return Vec::new(),
    };
    let mut others = groups.iter();
    let Some(other) = others.find(|g| g.protocol == without && g.same_windows(group)) else {
        return Vec::new();
    };
    let mut models = Vec::new();
    for (line, forecaster) in group.labelled() {
        let same = |other: &&TableLine<'_>| is_same_model(line, other);
        let Some(alone) = other.lines.iter().find(same) else {
            continue;
        };
        for fold in group.folds() {
            let (Some(watching), Some(alone)) = (line.blocks(fold), alone.blocks(fold)) else {
                continue;
            };
            for recording in watching.chunk_by(|a, b| a.recording == b.recording) {
                let same = |block: &&BlockErrors| block.recording == recording[0].recording;
                let alone: Vec<BlockErrors> = alone.iter().filter(same).cloned().collect();
                if !alone.is_empty() {
                    models.push(Watched {
                        forecaster: forecaster.clone(),
                        watching: recording.to_vec(),
                        alone,
                    });
                }
            }
        }
    }
    models
}

/// A table for an online group: a row for each model and recording, a column for each quarter of the recording.
pub(super) fn parts(group: &ResultGroup<'_>, groups: &[ResultGroup<'_>]) -> Vec<Part> {
    let models = watched(group, groups);
    if models.is_empty() {
        return Vec::new();
    }
    let columns = ["first quarter", "second", "third", "last"];
    let mut table = Table::new(["forecaster", "recording"].into_iter().chain(columns)).text_column("recording");
    for watched in &models {
        let cells = by_quarter(&watched.watching).into_iter();
        let cells = cells.zip(by_quarter(&watched.alone)).map(cell);
        let start = [watched.forecaster.clone(), watched.recording().to_owned()];
        table.row(start.into_iter().chain(cells));
    }
    vec![
        Part::subheading("Error over watching time"),
        Part::Paragraph(NOTE.to_owned()),
        Part::Table(table.captioned(format!(
            "{} in metres, mean over the pedestrians of a quarter and over seeds. {}",
            error(group.protocol),
            group.conditions_in_words()
        ))),
    ]
}

fn error(protocol: Protocol) -> &'static str {
    if protocol.hypotheses() == 1 { "FDE" } else { "minFDE" }
}

fn is_same_model(line: &TableLine<'_>, other: &TableLine<'_>) -> bool {
    let (mine, its) = (line.conditions(), other.conditions());
    mine.epochs.is_some()
        && (&mine.forecaster, &mine.variant, mine.epochs, line.seeds())
            == (&its.forecaster, &its.variant, its.epochs, other.seeds())
}

/// Mean minFDE of each quarter of a recording (m); `None` for a quarter in which no window starts.
fn by_quarter(blocks: &[BlockErrors]) -> [Option<f64>; QUARTERS] {
    let first = blocks.iter().map(|block| block.block).min().unwrap_or(0);
    let last = blocks.iter().map(|block| block.block).max().unwrap_or(0);
    let quarter = |block: &BlockErrors| (block.block - first) * QUARTERS as i64 / (last - first + 1);
    std::array::from_fn(|wanted| {
        let of_quarter = || blocks.iter().filter(|block| quarter(block) == wanted as i64);
        of_quarter().next().map(|_| mean(of_quarter()))
    })
}

/// Mean minFDE over the pedestrians of the blocks, m.
fn mean<'a>(blocks: impl Iterator<Item = &'a BlockErrors>) -> f64 {
    let sums = blocks.map(|block| (block.pedestrians as f64, block.min_fde));
    let (pedestrians, sum) = sums.fold((0.0, 0.0), |a, b| (a.0 + b.0, a.1 + b.1));
    sum / pedestrians
}

fn cell((watching, alone): (Option<f64>, Option<f64>)) -> String {
    let both = watching.zip(alone);
    or_nothing(both.map(|(watching, alone)| {
        let change = 100.0 * (watching / alone - 1.0);
        format!("{watching:.3} ({change:+.1} %)")
    }))
}
