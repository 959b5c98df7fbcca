//! The record of the evaluation in a run's `report.json`. An evaluation that equals the record is not repeated.

use crate::error::DdlError;
use crate::evaluation::evaluate::EvaluationRequest;
use crate::model::ddl::Ddl;
use crate::run::directory::{RunDirectory, read_json, write_atomically, write_compact_json, write_json};
use crate::run::lock::RunLock;
use crate::run::training_data::digest_of_recording;
use crate::trust::calibration::Calibration;
use ddl_data::{Dataset, Recording};
use ddl_report::{ForecastSnapshot, Report};
use serde::{Deserialize, Serialize};

/// Everything the results depend on besides the run itself.
#[derive(Debug, PartialEq, Serialize, Deserialize)]
struct EvaluationRecord {
    request: EvaluationRequest,
    #[serde(default)]
    recordings: Vec<MeasuredRecording>,
    device: String,
    /// Version of the set of rows; an older set is evaluated again.
    #[serde(default)]
    rows: u32,
    /// SHA-256 of the calibration constants that forecasts depend on.
    #[serde(default)]
    calibration: String,
}

#[derive(Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct MeasuredRecording {
    pub(crate) name: String,
    frame_step: i64,
    pub(crate) sha256: String,
}

/// 1: with the row of the packed model. 2: the central goal is drawn towards the extrapolated last step. 3: the
/// single forecast is straight. 4: motion is bounded. 5: the row of the packed model is called so. 6: further
/// rows of `published`, whose epoch is chosen on all headline windows. 7: more tracks begin anew after a jump. 8: a row
/// that the next one refutes is left out, and exchanged ids go on.
const ROWS: u32 = 8;

impl EvaluationRecord {
    fn new(model: &Ddl, dataset: &Dataset, request: &EvaluationRequest) -> Self {
        let measured = |recording: &Recording| MeasuredRecording {
            name: recording.name().to_owned(),
            frame_step: recording.frame_step(),
            sha256: digest_of_recording(recording),
        };
        Self {
            request: request.clone(),
            recordings: dataset.recordings().iter().map(measured).collect(),
            device: model.device().words().to_owned(),
            rows: ROWS,
            calibration: Calibration::digest(),
        }
    }
}

/// Whether the model's run already holds the results of exactly this evaluation on these recordings. A packed model
/// holds none.
#[must_use]
pub fn is_evaluated(model: &Ddl, dataset: &Dataset, request: &EvaluationRequest) -> bool {
    let Some(run) = model.run() else {
        return false;
    };
    let record = run.record();
    if ![&record, &run.report(), &run.moments()].iter().all(|file| file.is_file()) {
        return false;
    }
    // A record that cannot be read, such as one of another version, does not count.
    read_json::<EvaluationRecord>(&record).is_ok_and(|done| done == EvaluationRecord::new(model, dataset, request))
}

/// Writes `report.json` and `moments.json` of the model's run, then the record of the request.
///
/// # Errors
/// When a file cannot be written, or the model is packed and has no run.
pub fn save_evaluation(
    model: &Ddl,
    dataset: &Dataset,
    request: &EvaluationRequest,
    report: &Report,
    moments: &[ForecastSnapshot],
) -> Result<(), DdlError> {
    let Some(run) = model.run() else {
        return Err(model.source().wrong("has no run directory for results; write them elsewhere (`Results::save`)"));
    };
    let _claimed = RunLock::wait(run.path())?;
    let record = run.record();
    if record.is_file() {
        // Remove the record first, so that it never belongs to a half-written report.
        std::fs::remove_file(&record).map_err(|error| DdlError::io(&record, error))?;
    }
    let json = report.to_json()?;
    write_atomically(&run.report(), json.as_bytes())?;
    write_compact_json(&run.moments(), &moments)?;
    write_json(&record, &EvaluationRecord::new(model, dataset, request))
}

/// The recordings that a run was evaluated on; empty without a record of this version.
pub(crate) fn measured_recordings(run: &RunDirectory) -> Vec<MeasuredRecording> {
    read_json(&run.record()).map_or_else(|_| Vec::new(), |record: EvaluationRecord| record.recordings)
}
