//! Errors summed over blocks of time.

use std::collections::BTreeMap;

use ddl_core::{Forecast, Window};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use crate::error::EvaluationError;
use crate::metric::displacement::DisplacementErrors;
use crate::protocol::Protocol;
use crate::scored_window::ScoredWindow;

/// Length of a block in steps of 0.4 s: 20 s. A window belongs to the block in which it starts.
pub(crate) const BLOCK_STEPS: i64 = 50;

/// The errors of all windows of a recording that start within the same 20 s.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct BlockErrors {
    /// The recording.
    pub recording: String,
    /// Number of the block, counted from raw frame 0 of the recording.
    pub block: i64,
    /// Pedestrians in its windows; one in several windows counts in each.
    pub pedestrians: usize,
    /// Sum over them of minADE, m; under `joint` of the JADE of their windows.
    pub min_ade: f64,
    /// Sum over them of minFDE, m; under `joint` of the JFDE of their windows.
    pub min_fde: f64,
}

impl BlockErrors {
    /// Whether both have the same windows: recording, block and pedestrians agree.
    pub fn same_windows(&self, other: &Self) -> bool {
        (&self.recording, self.block, self.pedestrians) == (&other.recording, other.block, other.pedestrians)
    }
}

/// Sums the errors of a protocol, of forecasts with one for each window, by recording and by time.
///
/// # Errors
/// A window has no future, or a forecast does not belong to its window's pedestrians.
pub fn block_errors(
    protocol: Protocol,
    windows: &[Window],
    forecasts: &[Forecast],
) -> Result<Vec<BlockErrors>, EvaluationError> {
    EvaluationError::unless_one_each(windows, forecasts.len())?;
    let sums: Vec<[f64; 2]> = windows
        .par_iter()
        .zip(forecasts)
        .map(|(window, forecast)| {
            let errors = DisplacementErrors::of(&ScoredWindow::new(window, forecast)?);
            if protocol == Protocol::Joint {
                return Ok(errors.joint().map(|mean| mean * window.len() as f64));
            }
            let sum =
                |metric: fn(&DisplacementErrors, usize) -> f64| (0..window.len()).map(|i| metric(&errors, i)).sum();
            Ok([sum(DisplacementErrors::min_ade), sum(DisplacementErrors::min_fde)])
        })
        .collect::<Result<_, EvaluationError>>()?;
    let mut blocks: BTreeMap<(&str, i64), BlockErrors> = BTreeMap::new();
    for (window, [min_ade, min_fde]) in windows.iter().zip(sums) {
        let block = window.start_frame().div_euclid(BLOCK_STEPS.saturating_mul(window.frame_step()));
        let sum = blocks.entry((window.recording(), block)).or_insert_with(|| BlockErrors {
            recording: window.recording().to_owned(),
            block,
            pedestrians: 0,
            min_ade: 0.0,
            min_fde: 0.0,
        });
        sum.pedestrians += window.len();
        sum.min_ade += min_ade;
        sum.min_fde += min_fde;
    }
    Ok(blocks.into_values().collect())
}

/// Blocks of one recording with a mean minADE each, and twice as much minFDE.
#[cfg(test)]
pub(super) fn blocks_of(pedestrians: usize, errors: &[f64]) -> Vec<BlockErrors> {
    let sum = pedestrians as f64;
    (0..)
        .zip(errors)
        .map(|(block, &error)| BlockErrors {
            recording: "a".to_owned(),
            block,
            pedestrians,
            min_ade: sum * error,
            min_fde: 2.0 * sum * error,
        })
        .collect()
}
