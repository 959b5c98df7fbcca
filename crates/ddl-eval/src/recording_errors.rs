//! The errors of a result recording by recording.

use crate::ResultRow;

/// The errors of one forecaster on one of several recordings that were measured together.
#[derive(Debug, Clone, PartialEq)]
pub struct RecordingErrors {
    /// The recording.
    pub recording: String,
    /// Pedestrians in its windows; one in several windows counts in each.
    pub pedestrians: usize,
    /// Their mean minADE, m.
    pub min_ade: f64,
    /// Their mean minFDE, m.
    pub min_fde: f64,
}

impl ResultRow {
    /// The errors of each recording, by name; nothing where the row does not know its errors by block.
    ///
    /// The mean over the recordings, weighted by their pedestrians, is that of the row.
    pub fn by_recording(&self) -> Vec<RecordingErrors> {
        let mut recordings: Vec<RecordingErrors> = Vec::new();
        // blocks stand in the order of their recordings
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
