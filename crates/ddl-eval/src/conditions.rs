//! Results with the conditions under which they were measured.

use ddl_core::{Forecast, Forecaster, Window};
use ddl_data::{Convention, WindowRule};
use serde::{Deserialize, Serialize};

use crate::error::EvaluationError;
use crate::protocol::Protocol;
use crate::scored_window::indices_in_full;
use crate::scores::Scores;
use crate::significance::{BlockErrors, block_errors};

/// Conditions of a result. Results are comparable when convention, window rule, protocol and test subset agree.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Conditions {
    /// Data convention of the recordings.
    pub convention: Convention,
    /// Rule that cut the test windows.
    pub window_rule: WindowRule,
    /// Evaluation protocol.
    pub protocol: Protocol,
    /// Fold: the scene tested on.
    pub fold: String,
    /// Name of the forecaster.
    pub forecaster: String,
    /// Ablation variant (`full`, `no-goal-shift`, `no-dynamics` or `star`), and the backbone if it is not STAR.
    pub variant: Option<String>,
    /// Seed of the training and of the samples; `None` when nothing is random.
    pub seed: Option<u64>,
    /// Training epochs; `None` when nothing is trained.
    pub epochs: Option<usize>,
    /// Choice of the scored epoch, such as `last epoch`.
    pub selection: Option<String>,
    /// Text with the batch size and step size of the training and the source of the goals; `None` when neither applies.
    pub recipe: Option<String>,
    /// Device the forecasts were computed on, such as `cpu`; empty when unknown.
    #[serde(default)]
    pub device: String,
    /// Commit of the project; empty when unknown.
    #[serde(default)]
    pub commit: String,
    /// Text that describes the used part of the training windows, the same for every fold; `None` for all windows.
    pub training_subset: Option<String>,
    /// Text that describes the scored part of the test windows, the same for every fold; `None` for all windows.
    pub test_subset: Option<String>,
}

impl Conditions {
    /// Conditions of a forecaster without training and randomness, on all test windows.
    pub fn new(
        convention: Convention,
        window_rule: WindowRule,
        protocol: Protocol,
        fold: impl Into<String>,
        forecaster: impl Into<String>,
    ) -> Self {
        Self {
            convention,
            window_rule,
            protocol,
            fold: fold.into(),
            forecaster: forecaster.into(),
            variant: None,
            seed: None,
            epochs: None,
            selection: None,
            recipe: None,
            device: String::new(),
            commit: String::new(),
            training_subset: None,
            test_subset: None,
        }
    }

    /// Forecaster and variant for the first column of tables; the variant `full` is left out.
    pub fn label(&self) -> String {
        match self.variant.as_deref() {
            None | Some("full") => self.forecaster.clone(),
            Some(variant) => format!("{} ({variant})", self.forecaster),
        }
    }
}

/// One result: the scores of one forecaster on one fold under one protocol.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ResultRow {
    /// Its conditions.
    pub conditions: Conditions,
    /// Its metrics.
    pub scores: Scores,
    /// Errors summed over blocks of 20 s, for intervals of the means; empty when unknown.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub blocks: Vec<BlockErrors>,
}

impl ResultRow {
    /// Forecasts the windows under the protocol of the conditions and scores the forecasts.
    ///
    /// The caller ensures that the windows agree with the conditions.
    ///
    /// # Errors
    /// The forecaster failed or violated the protocol, or its forecasts cannot be scored.
    pub fn measure(
        conditions: Conditions,
        forecaster: &(impl Forecaster + ?Sized),
        windows: &[Window],
    ) -> Result<Self, EvaluationError> {
        Self::measure_among(conditions, forecaster, windows, windows)
    }

    pub(crate) fn measure_among(
        conditions: Conditions,
        forecaster: &(impl Forecaster + ?Sized),
        windows: &[Window],
        full_windows: &[Window],
    ) -> Result<Self, EvaluationError> {
        let mut forecasts = conditions.protocol.forecast(forecaster, full_windows)?;
        for (forecast, (window, full_window)) in forecasts.iter_mut().zip(windows.iter().zip(full_windows)) {
            // Mismatches are reported by the scoring.
            if let Some(indices) = indices_in_full(window, full_window)
                && indices.len() < forecast.pedestrians()
                && forecast.pedestrians() == full_window.len()
            {
                *forecast = forecast.of_pedestrians(&indices);
            }
        }
        Self::score_among(conditions, windows, full_windows, &forecasts)
    }

    /// Scores given forecasts, one for each window.
    ///
    /// # Errors
    /// As [`Scores::evaluate`].
    pub fn score(conditions: Conditions, windows: &[Window], forecasts: &[Forecast]) -> Result<Self, EvaluationError> {
        Self::score_among(conditions, windows, windows, forecasts)
    }

    pub(crate) fn score_among(
        conditions: Conditions,
        windows: &[Window],
        full_windows: &[Window],
        forecasts: &[Forecast],
    ) -> Result<Self, EvaluationError> {
        let protocol = conditions.protocol;
        Ok(Self {
            conditions,
            scores: Scores::under(protocol, windows, full_windows, forecasts)?,
            blocks: block_errors(protocol, windows, forecasts)?,
        })
    }

    /// The errors of each recording, by name; empty if the row has no errors by block.
    ///
    /// The mean over the recordings, weighted by their pedestrians, is that of the row.
    pub fn by_recording(&self) -> Vec<RecordingErrors> {
        let mut recordings: Vec<RecordingErrors> = Vec::new();
        // Blocks are in the order of their recordings.
        for of_one in self.blocks.chunk_by(|a, b| a.recording == b.recording) {
            let pedestrians = of_one.iter().map(|block| block.pedestrians).sum::<usize>();
            let count = pedestrians.max(1) as f64;
            recordings.push(RecordingErrors {
                recording: of_one[0].recording.clone(),
                pedestrians,
                min_ade: of_one.iter().map(|block| block.min_ade).sum::<f64>() / count,
                min_fde: of_one.iter().map(|block| block.min_fde).sum::<f64>() / count,
            });
        }
        recordings
    }
}

/// The errors of one forecaster on one of several recordings that were measured together.
#[derive(Debug, Clone, PartialEq)]
pub struct RecordingErrors {
    /// The recording.
    pub recording: String,
    /// Pedestrians in its windows; one in several windows counts in each.
    pub pedestrians: usize,
    /// Their mean minADE, m; under `joint` JADE.
    pub min_ade: f64,
    /// Their mean minFDE, m; under `joint` JFDE.
    pub min_fde: f64,
}
