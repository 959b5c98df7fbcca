//! The part of a track that a retrieval may read, and its velocities.

use crate::error::TrackError;
use serde::{Deserialize, Serialize};

/// The part of a track that a retrieval may read.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum QuerySpan {
    /// The 7 forward differences of the 8 observed positions, without the future. Used by every protocol except
    /// `published`.
    #[default]
    Observed,
    /// 8 forward differences, as in the published code: the last one reads position 9, the first one to be forecast.
    /// Only to reproduce published numbers.
    PublishedFuture,
}

impl QuerySpan {
    /// Number of velocities compared: 7 or 8.
    pub(crate) fn velocities(self) -> usize {
        match self {
            Self::Observed => 7,
            Self::PublishedFuture => 8,
        }
    }

    /// Number of positions read, from the first: 8 or 9.
    pub fn positions(self) -> usize {
        self.velocities() + 1
    }
}

/// Forward differences (m/s) of the positions that `span` may read; later positions are ignored.
///
/// # Shapes
/// `track`: at least [`QuerySpan::positions`] positions (m), `time_step` (s) apart.
pub(crate) fn velocities(track: &[[f64; 2]], time_step: f64, span: QuerySpan) -> Result<Vec<[f64; 2]>, TrackError> {
    let needed = span.positions();
    let read = track.get(..needed).ok_or(TrackError::TooShort { positions: track.len(), needed })?;
    check_finite(read)?;
    read.windows(2)
        .enumerate()
        .map(|(index, pair)| {
            let velocity = [0, 1].map(|d| (pair[1][d] - pair[0][d]) / time_step);
            let finite = velocity.iter().all(|component| component.is_finite());
            finite.then_some(velocity).ok_or(TrackError::VelocityOverflow { index })
        })
        .collect()
}

pub(crate) fn check_finite(positions: &[[f64; 2]]) -> Result<(), TrackError> {
    match positions.iter().position(|p| !(p[0].is_finite() && p[1].is_finite())) {
        Some(index) => Err(TrackError::NonFinite { index, x: positions[index][0], y: positions[index][1] }),
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    #![expect(clippy::float_cmp, reason = "the results are exact")]

    use super::{QuerySpan, velocities};

    fn walk(positions: usize) -> Vec<[f64; 2]> {
        (0..positions).map(|i| [0.5 * i as f64, -(i as f64).powi(2)]).collect()
    }

    #[test]
    fn velocities_are_forward_differences_of_the_positions_read() {
        let observed = velocities(&walk(8), 0.5, QuerySpan::Observed).unwrap();
        assert_eq!(observed.len(), 7);
        assert_eq!(observed[0], [1.0, -2.0]);
        assert_eq!(observed[6], [1.0, -26.0]);
        let published = velocities(&walk(9), 0.5, QuerySpan::PublishedFuture).unwrap();
        assert_eq!(published[..7], observed[..]);
        assert_eq!(published[7], [1.0, -30.0]);
    }
}
