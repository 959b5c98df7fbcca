//! A run beside another model on the validation part of the run.

use crate::error::DdlError;
use crate::evaluation::parts::{parts, pedestrians};
use crate::model::ddl::Ddl;
use crate::windows::test_set::TestSet;
use ddl_core::WorkDone;
use ddl_data::Dataset;
use ddl_eval::Protocol;
use ddl_eval::significance::{BlockErrors, PairedDifference, block_errors, paired_difference};
use serde::Serialize;
use std::ops::ControlFlow;

/// Errors of the best of 20 hypotheses in metres, means over pedestrians.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct BestOf20Errors {
    /// minADE.
    pub min_ade: f64,
    /// minFDE.
    pub min_fde: f64,
}

impl BestOf20Errors {
    fn of(blocks: &[BlockErrors]) -> Self {
        let pedestrians: usize = blocks.iter().map(|block| block.pedestrians).sum();
        let mean = |metric: fn(&BlockErrors) -> f64| blocks.iter().map(metric).sum::<f64>() / pedestrians.max(1) as f64;
        Self { min_ade: mean(|block| block.min_ade), min_fde: mean(|block| block.min_fde) }
    }
}

/// A run and another model on the same windows, under the protocol `fair`.
#[derive(Debug, Clone, PartialEq)]
pub struct Comparison {
    /// Pedestrians in the windows, each counted once for each window.
    pub pedestrians: usize,
    /// The run.
    pub run: BestOf20Errors,
    /// The other model.
    pub other: BestOf20Errors,
    /// The minADE of the run minus that of the other model, with its interval; `None` where the windows start in fewer
    /// than 10 blocks of 20 s.
    pub difference: Option<PairedDifference>,
    /// Whether the other model was trained on some of these recordings: then its errors are too small.
    pub other_knows_them: bool,
}

/// Measures a run and another model on all validation windows of the run, as [`evaluate`](crate::evaluate) does under
/// the protocol `fair`.
///
/// # Errors
/// When the run kept no validation part, or the data is not its training data; [`DdlError::Interrupted`] when the
/// observer asks to stop.
pub fn compare_on_validation(
    run: &Ddl,
    other: &Ddl,
    dataset: &Dataset,
    mut observe: impl FnMut(WorkDone) -> ControlFlow<()>,
) -> Result<Comparison, DdlError> {
    let windows = TestSet::kept_by(run.goal_model(), dataset, None)?.windows;
    let mut progress = WorkDone { done: 0, total: 2 * windows.len() as u64 };
    let mut measured = |model: &Ddl| -> Result<Vec<BlockErrors>, DdlError> {
        let mut forecasts = Vec::new();
        for some in parts(&windows) {
            forecasts.extend(Protocol::Fair.forecast(model, some)?);
            progress.done += some.len() as u64;
            if observe(progress).is_break() {
                return Err(DdlError::Interrupted);
            }
        }
        Ok(block_errors(Protocol::Fair, &windows, &forecasts)?)
    };
    let (of_run, of_other) = (measured(run)?, measured(other)?);
    Ok(Comparison {
        pedestrians: pedestrians(&windows),
        run: BestOf20Errors::of(&of_run),
        other: BestOf20Errors::of(&of_other),
        other_knows_them: dataset.recordings().iter().any(|recording| {
            let is_compared = windows.iter().any(|window| window.recording() == recording.name());
            is_compared && other.goal_model().known_share(recording).is_some()
        }),
        difference: paired_difference(&[&of_run], &[&of_other], |block| block.min_ade),
    })
}
