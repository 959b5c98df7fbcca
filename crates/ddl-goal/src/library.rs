//! The library of complete tracks.

use crate::error::{LibraryError, TrackError};
use crate::span::check_finite;
use ddl_core::WINDOW;

/// Complete tracks of pedestrians from the training scenes; the most similar ones are retrieved as experts.
///
/// # Examples
/// ```
/// use ddl_goal::ExpertLibrary;
/// let track: Vec<[f64; 2]> = (0..20).map(|i| [0.5 * f64::from(i), 0.0]).collect();
/// let library = ExpertLibrary::new(vec![track], 0.4)?;
/// assert_eq!(library.tracks().len(), 1);
/// # Ok::<(), ddl_goal::LibraryError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct ExpertLibrary {
    /// Seconds between two positions of a track.
    pub(crate) time_step: f64,
    tracks: Vec<Vec<[f64; 2]>>,
}

impl ExpertLibrary {
    /// Creates a library of tracks sampled every `time_step` seconds.
    ///
    /// # Shapes
    /// `tracks`: at least one, each of 20 positions (m): 8 observed and 12 to forecast.
    ///
    /// # Errors
    /// If the list is empty, a track has another length or a position that is not finite, or the time step is not
    /// positive.
    pub fn new(tracks: Vec<Vec<[f64; 2]>>, time_step: f64) -> Result<Self, LibraryError> {
        if !(time_step.is_finite() && time_step > 0.0) {
            return Err(LibraryError::InvalidTimeStep { time_step });
        }
        if tracks.is_empty() {
            return Err(LibraryError::Empty);
        }
        let library = Self { time_step, tracks };
        library.of_each(|track| {
            let (positions, needed) = (track.len(), WINDOW);
            if positions != needed {
                return Err(TrackError::WrongLength { positions, needed });
            }
            check_finite(track)
        })?;
        Ok(library)
    }

    pub(crate) fn of_each<T>(
        &self,
        make: impl Fn(&[[f64; 2]]) -> Result<T, TrackError>,
    ) -> Result<Vec<T>, LibraryError> {
        let tracks = self.tracks.iter().enumerate();
        tracks.map(|(index, track)| make(track).map_err(|source| LibraryError::Track { index, source })).collect()
    }

    /// The tracks, at least one, positions in metres.
    pub fn tracks(&self) -> &[Vec<[f64; 2]>] {
        &self.tracks
    }

    /// Endpoint of track `index` relative to its first position (m): equation 6 of the paper.
    ///
    /// # Panics
    /// If there is no such track.
    pub(crate) fn end(&self, index: usize) -> [f64; 2] {
        let track = &self.tracks[index];
        [0, 1].map(|d| track[WINDOW - 1][d] - track[0][d])
    }
}

#[cfg(test)]
mod tests {
    use super::ExpertLibrary;
    use crate::error::{LibraryError, TrackError};

    #[test]
    fn invalid_tracks_are_reported() {
        let track = vec![[0.0, 1.0]; 20];
        let refused = |tracks: &[&[[f64; 2]]], time_step| {
            let tracks = tracks.iter().map(|track| track.to_vec()).collect();
            ExpertLibrary::new(tracks, time_step).unwrap_err()
        };
        assert_eq!(refused(&[], 0.4), LibraryError::Empty);
        let time_step = refused(&[&track], f64::NAN).to_string();
        assert!(time_step.starts_with("the time step is NaN s"));
        let (positions, needed) = (8, 20);
        let source = TrackError::WrongLength { positions, needed };
        assert_eq!(refused(&[&track, &track[..8]], 0.4), LibraryError::Track { index: 1, source });
        let mut broken = track;
        broken[19][1] = f64::INFINITY;
        let error = refused(&[&broken], 0.4).to_string();
        assert_eq!(error, "track 0 of the library: position 19 is (0, inf): must be finite");
    }
}
