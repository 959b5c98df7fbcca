//! What watching is worth, by how long a recording has been watched: `online` forecasts beside those that the same model
//! makes without it.

use super::group::{ResultGroup, TableLine};
use crate::document::{Part, Table};
use ddl_eval::Protocol;
use ddl_eval::significance::BlockErrors;

const QUARTERS: usize = 4;

const NOTE: &str = "By quarters of the time from the first to the last window of a recording. In brackets: the change against the same model \
    without the memory of the recording, on the same windows. These are numbers of two protocols: the change says what watching is \
    worth to a camera, and is no progress of the method.";

/// A table for each online group: a row for each model and recording, a column for each quarter of the recording.
pub(super) fn parts(group: &ResultGroup<'_>, groups: &[ResultGroup<'_>]) -> Vec<Part> {
    let without = match group.protocol {
        Protocol::Online => Protocol::Fair,
        Protocol::OnlineSingle => Protocol::Single,
        Protocol::Published | Protocol::Fair | Protocol::Single => return Vec::new(),
    };
    let mut others = groups.iter();
    let Some(other) = others.find(|g| g.protocol == without && g.same_windows(group)) else {
        return Vec::new();
    };
    let columns = ["first quarter", "second", "third", "last"];
    let mut table =
        Table::new(["forecaster", "recording"].into_iter().chain(columns)).text_column("recording");
    for (line, label) in group.labelled() {
        let same = |other: &&TableLine<'_>| is_same_model(line, other);
        let Some(alone) = other.lines.iter().find(same) else {
            continue;
        };
        for fold in group.folds() {
            let (Some(watching), Some(alone)) = (line.blocks(fold), alone.blocks(fold)) else {
                continue;
            };
            for recording in watching.chunk_by(|a, b| a.recording == b.recording) {
                let mean = |blocks: &[BlockErrors]| by_quarter(&recording[0].recording, blocks);
                let cells = mean(&watching).into_iter().zip(mean(&alone));
                let start = [label.clone(), recording[0].recording.clone()];
                table.row(start.into_iter().chain(cells.map(cell)));
            }
        }
    }
    if table.rows().is_empty() {
        return Vec::new();
    }
    let error = if group.protocol.hypotheses() == 1 {
        "FDE"
    } else {
        "minFDE"
    };
    vec![
        Part::subheading("Error over watching time"),
        Part::Paragraph(NOTE.to_owned()),
        Part::Table(table.captioned(format!(
            "{error} in metres, mean over the pedestrians of a quarter and over seeds. {}",
            group.conditions_in_words()
        ))),
    ]
}

fn is_same_model(line: &TableLine<'_>, other: &TableLine<'_>) -> bool {
    let (mine, its) = (line.conditions(), other.conditions());
    mine.epochs.is_some()
        && (&mine.forecaster, &mine.variant, mine.epochs, line.seeds())
            == (&its.forecaster, &its.variant, its.epochs, other.seeds())
}

/// Mean minFDE of each quarter of a recording (m); `None` for one in which no window starts.
fn by_quarter(recording: &str, blocks: &[BlockErrors]) -> [Option<f64>; QUARTERS] {
    let of_recording = || blocks.iter().filter(|block| block.recording == recording);
    let first = of_recording().map(|block| block.block).min().unwrap_or(0);
    let last = of_recording().map(|block| block.block).max().unwrap_or(0);
    let quarter = |block: i64| (block - first) * QUARTERS as i64 / (last - first + 1);
    std::array::from_fn(|wanted| {
        let of_quarter = || of_recording().filter(|block| quarter(block.block) == wanted as i64);
        let pedestrians: usize = of_quarter().map(|block| block.pedestrians).sum();
        let sum: f64 = of_quarter().map(|block| block.min_fde).sum();
        (pedestrians > 0).then(|| sum / pedestrians as f64)
    })
}

fn cell((watching, alone): (Option<f64>, Option<f64>)) -> String {
    match (watching, alone) {
        (Some(watching), Some(alone)) => {
            let change = 100.0 * (watching / alone - 1.0);
            format!("{watching:.3} ({change:+.1} %)")
        }
        _ => super::cells::NOTHING.to_owned(),
    }
}
