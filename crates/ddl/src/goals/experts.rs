//! The expert library as a file of a run.

use crate::error::DdlError;
use crate::run::directory::write_atomically;
use ddl_data::{Position, TIME_STEP, WINDOW, Window};
use ddl_goal::ExpertLibrary;
use ddl_network::weights::{Origin, check_digest, tensors_digest};
use safetensors::SafeTensors;
use safetensors::tensor::{Dtype, TensorView};
use std::io::Read as _;
use std::path::Path;

const TRACKS: &str = "tracks";
/// Bytes of a track: 20 positions of two f64.
const TRACK_BYTES: usize = WINDOW * 2 * 8;
const REMEDY: &str = "copy it again, or delete it and run the same training again";
const HEADER_BYTES: u64 = 1 << 20;

pub(crate) fn library(windows: &[Window]) -> Result<ExpertLibrary, DdlError> {
    let tracks: Vec<Vec<Position>> = windows
        .iter()
        .flat_map(|window| (0..window.len()).map(|i| window.track(i).to_vec()))
        .collect();
    Ok(ExpertLibrary::new(tracks, TIME_STEP)?)
}

pub(crate) fn save(library: &ExpertLibrary, origin: &Origin, path: &Path) -> Result<(), DdlError> {
    let bytes: Vec<u8> = library
        .tracks()
        .iter()
        .flatten()
        .flatten()
        .flat_map(|coordinate| coordinate.to_le_bytes())
        .collect();
    let shape = vec![library.tracks().len(), WINDOW, 2];
    let broken = |error: safetensors::SafeTensorError| DdlError::run(path, error.to_string());
    let view = TensorView::new(Dtype::F64, shape, &bytes).map_err(broken)?;
    let header = origin.to_header(&tensors_digest([(TRACKS, view.clone())]));
    let file = safetensors::serialize([(TRACKS, view)], Some(header)).map_err(broken)?;
    write_atomically(path, &file)
}

/// Loads the library of a run of this origin. The configuration of the run gives its number of `tracks`.
pub(crate) fn load(origin: &Origin, tracks: usize, path: &Path) -> Result<ExpertLibrary, DdlError> {
    // Reads and allocates at most the size of the run's library.
    let most = (tracks as u64)
        .saturating_mul(TRACK_BYTES as u64)
        .saturating_add(HEADER_BYTES);
    let mut bytes = Vec::new();
    let file = std::fs::File::open(path).map_err(|error| DdlError::io(path, error))?;
    file.take(most.saturating_add(1))
        .read_to_end(&mut bytes)
        .map_err(|error| DdlError::io(path, error))?;
    if bytes.len() as u64 > most {
        let problem = format!("is longer than {most} bytes, the size of {tracks} tracks");
        return Err(DdlError::run(path, problem));
    }
    let broken = |error: safetensors::SafeTensorError| {
        let problem =
            format!("is not a complete safetensors file ({error}); delete it and run the same training again");
        DdlError::run(path, problem)
    };
    let (_, header) = SafeTensors::read_metadata(&bytes).map_err(broken)?;
    let (of_file, digest) = Origin::from_header(header.metadata().as_ref());
    if let Some(difference) = of_file.difference(origin) {
        return Err(DdlError::run(
            path,
            format!(
                "belongs to another run than the config.json beside it: its {difference}; restore the file or the \
                 config.json that it was made with"
            ),
        ));
    }
    let file = SafeTensors::deserialize(&bytes).map_err(broken)?;
    check_digest(&file, digest.as_deref(), path)?;
    let view = file
        .tensor(TRACKS)
        .map_err(|error| DdlError::run(path, format!("has no tracks ({error}); {REMEDY}")))?;
    if view.dtype() != Dtype::F64 || view.shape() != [tracks, WINDOW, 2] {
        let problem = format!(
            "has {:?} {:?} for `{TRACKS}`, expected {tracks} f64 tracks of {WINDOW} positions; {REMEDY}",
            view.dtype(),
            view.shape()
        );
        return Err(DdlError::run(path, problem));
    }
    let (numbers, _) = view.data().as_chunks::<8>();
    let numbers: Vec<f64> = numbers.iter().map(|&bytes| f64::from_le_bytes(bytes)).collect();
    let (positions, _) = numbers.as_chunks::<2>();
    let tracks = positions.chunks_exact(WINDOW).map(<[_]>::to_vec).collect();
    ExpertLibrary::new(tracks, TIME_STEP).map_err(|error| unusable(&error, path))
}

/// The error for a library of the right shape that is unusable: impossible tracks, or too few tracks.
pub(crate) fn unusable(error: &dyn std::error::Error, path: &Path) -> DdlError {
    DdlError::run(path, format!("cannot be used: {error}; {REMEDY}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A library of two tracks, read from a file without the SHA-256 that would reveal the change.
    fn read(change: impl FnOnce(&mut [f64])) -> Result<ExpertLibrary, DdlError> {
        let mut numbers: Vec<f64> = (0..2 * WINDOW * 2).map(|i| 0.25 * i as f64).collect();
        change(&mut numbers);
        let bytes: Vec<u8> = numbers.iter().flat_map(|n| n.to_le_bytes()).collect();
        let view = TensorView::new(Dtype::F64, vec![2, WINDOW, 2], &bytes).unwrap();
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("experts.safetensors");
        std::fs::write(&path, safetensors::serialize([(TRACKS, view)], None).unwrap()).unwrap();
        load(&Origin::default(), 2, &path)
    }

    #[test]
    fn a_library_of_impossible_tracks_is_refused() {
        assert_eq!(read(|_| ()).unwrap().tracks().len(), 2);
        for (number, part) in [(f64::NAN, "position 3 is (NaN"), (f64::INFINITY, "must be finite")] {
            let error = read(|numbers| numbers[6] = number).unwrap_err().to_string();
            assert!(error.contains("experts.safetensors"), "{error}");
            assert!(error.contains(part) && error.contains(REMEDY), "{error}");
        }
    }
}
