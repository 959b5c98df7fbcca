//! The expert library as a file of a run.

use crate::error::DdlError;
use ddl_core::{Position, TIME_STEP, WINDOW, Window};
use ddl_goal::ExpertLibrary;
use ddl_network::weights::{Origin, StoredTensor, TensorData, find_tensor, read_tensors, write_tensors};
use std::path::Path;

const TRACKS: &str = "tracks";
/// Bytes of a track: 20 positions of two f64.
const TRACK_BYTES: u64 = WINDOW as u64 * 2 * 8;
const REMEDY: &str = "copy it again, or delete it and run the same training again";

pub(crate) fn library(windows: &[Window]) -> Result<ExpertLibrary, DdlError> {
    let tracks: Vec<Vec<Position>> =
        windows.iter().flat_map(|window| (0..window.len()).map(|i| window.track(i).to_vec())).collect();
    Ok(ExpertLibrary::new(tracks, TIME_STEP)?)
}

pub(crate) fn save(library: &ExpertLibrary, origin: &Origin, path: &Path) -> Result<(), DdlError> {
    let tensor = StoredTensor {
        name: TRACKS.to_owned(),
        shape: vec![library.tracks().len(), WINDOW, 2],
        numbers: TensorData::Double(library.tracks().iter().flatten().flatten().copied().collect()),
    };
    Ok(write_tensors(&[tensor], origin, path)?)
}

/// Loads the library of a run of this origin. The configuration of the run gives its number of `tracks`.
pub(crate) fn load(origin: &Origin, tracks: usize, path: &Path) -> Result<ExpertLibrary, DdlError> {
    let stored = read_tensors(path, (tracks as u64).saturating_mul(TRACK_BYTES), origin)?;
    let numbers = find_tensor(&stored, TRACKS, path)?.double(&[tracks, WINDOW, 2], path)?;
    let (positions, _) = numbers.as_chunks::<2>();
    let tracks = positions.chunks_exact(WINDOW).map(<[_]>::to_vec).collect();
    ExpertLibrary::new(tracks, TIME_STEP).map_err(|error| unusable(&error, path))
}

/// The error for a library of the right shape that is unusable: impossible tracks, or too few tracks.
pub(crate) fn unusable(error: &dyn std::error::Error, path: &Path) -> DdlError {
    DdlError::run(path, format!("cannot be used: {error}; {REMEDY}"))
}
