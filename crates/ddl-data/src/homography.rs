//! From pixels of a camera to metres on the ground.

use serde::{Deserialize, Serialize};
use thiserror::Error;

use crate::{
    COORDINATE_LIMIT, Observation, PedestrianName, PedestrianNames, Position, Recording,
    RecordingError,
};

const SIZE: usize = 3;

/// A plane seen by a camera: the matrix that takes pixels to metres on the ground.
///
/// With H the matrix, a pixel (u, v), column and row, is the place (X / W, Y / W) where (X, Y, W) = H (u, v, 1), as of
/// `OpenCV`'s `findHomography(pixels, metres)`. The `H.txt` of the ETH recordings counts (row, column): swap its first
/// two columns.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "[[f64; SIZE]; SIZE]")]
pub struct Homography([[f64; SIZE]; SIZE]);

impl TryFrom<[[f64; SIZE]; SIZE]> for Homography {
    type Error = HomographyError;

    fn try_from(rows: [[f64; SIZE]; SIZE]) -> Result<Self, HomographyError> {
        Self::new(rows)
    }
}

impl Homography {
    /// The matrix, row by row: it takes (u, v, 1) in pixels to (X, Y, W), of which X / W and Y / W are metres.
    ///
    /// # Errors
    /// [`HomographyError`] where an entry is not finite, or the matrix squeezes the plane into a line.
    pub fn new(rows: [[f64; SIZE]; SIZE]) -> Result<Self, HomographyError> {
        for (row, entries) in rows.iter().enumerate() {
            if let Some(column) = entries.iter().position(|entry| !entry.is_finite()) {
                return Err(HomographyError::NotFinite { row, column });
            }
        }
        // Relative to the size of the rows, which may be of any scale.
        let length = |row: &[f64; SIZE]| row.iter().map(|x| x * x).sum::<f64>().sqrt();
        let volume = determinant(&rows) / rows.iter().map(length).product::<f64>();
        // false for what is no number
        if volume.abs() > f64::EPSILON {
            Ok(Self(rows))
        } else {
            Err(HomographyError::Singular)
        }
    }

    /// Where a pixel is on the ground (m); `None` on the horizon, and so near to it that the place would be farther
    /// away than [`COORDINATE_LIMIT`].
    #[must_use]
    pub fn apply(&self, [u, v]: [f64; 2]) -> Option<Position> {
        let [x, y, w] = self.0.map(|[a, b, c]| a * u + b * v + c);
        let place = [x / w, y / w];
        // false for what is no number
        let near = place.iter().all(|c| c.abs() <= COORDINATE_LIMIT);
        near.then_some(place)
    }

    /// Where somebody who was seen at a pixel, and is named so, is on the ground (m).
    ///
    /// # Errors
    /// [`HomographyError::Horizon`] where that is nowhere.
    pub fn place(
        &self,
        seen: &Observation,
        names: &PedestrianNames,
    ) -> Result<Position, HomographyError> {
        let horizon = || HomographyError::Horizon {
            pedestrian: names.of(seen.pedestrian),
            frame: seen.frame,
            pixel: seen.position,
        };
        self.apply(seen.position).ok_or_else(horizon)
    }

    /// A recording in pixels, in metres.
    ///
    /// # Errors
    /// [`HomographyError::Horizon`] where somebody is nowhere on the ground.
    pub fn on_the_ground(&self, recording: &Recording) -> Result<Recording, HomographyError> {
        let mut observations = recording.observations().to_vec();
        for seen in &mut observations {
            seen.position = self.place(seen, recording.names())?;
        }
        Ok(recording.with_observations(recording.frame_step(), observations)?)
    }
}

fn determinant([[a, b, c], [d, e, f], [g, h, i]]: &[[f64; SIZE]; SIZE]) -> f64 {
    a * (e * i - f * h) - b * (d * i - f * g) + c * (d * h - e * g)
}

impl std::str::FromStr for Homography {
    type Err = HomographyError;

    /// Nine numbers, three a line, separated by blanks or commas.
    fn from_str(text: &str) -> Result<Self, HomographyError> {
        let mut rows = [[0.0; SIZE]; SIZE];
        let mut found = 0;
        for (index, line) in text.lines().enumerate() {
            let fields: Vec<&str> = line
                .split([' ', '\t', ','])
                .filter(|field| !field.trim().is_empty())
                .collect();
            if fields.is_empty() {
                continue;
            }
            let wrong = || HomographyError::Line {
                line: index + 1,
                found: line.chars().take(60).collect(),
            };
            let row = rows.get_mut(found).ok_or_else(wrong)?;
            if fields.len() != SIZE {
                return Err(wrong());
            }
            for (entry, field) in row.iter_mut().zip(fields) {
                *entry = field.trim().parse().map_err(|_| wrong())?;
            }
            found += 1;
        }
        if found < SIZE {
            return Err(HomographyError::Rows { found });
        }
        Self::new(rows)
    }
}

/// Why there is no [`Homography`], or no place on the ground.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
#[expect(missing_docs, reason = "the messages say what the fields are")]
pub enum HomographyError {
    #[error("row {}, column {} of the homography is not finite", .row + 1, .column + 1)]
    NotFinite { row: usize, column: usize },
    #[error("the homography is singular: it squeezes the plane into a line; is a row there twice?")]
    Singular,
    #[error(
        "line {line} of the homography must hold three numbers, and be one of three such lines, found {found:?}"
    )]
    Line { line: usize, found: String },
    #[error("a homography has three rows of three numbers, found {found}")]
    Rows { found: usize },
    #[error(
        "pedestrian {pedestrian}, frame {frame}: pixel {pixel:?} lies on the horizon of the homography; is it of this \
         camera, and from pixels to metres?"
    )]
    Horizon {
        pedestrian: PedestrianName,
        frame: i64,
        pixel: [f64; 2],
    },
    #[error(transparent)]
    Recording(#[from] RecordingError),
}
