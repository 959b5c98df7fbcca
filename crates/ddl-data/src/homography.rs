//! Conversion from pixels of a camera to metres on the ground.

use ddl_core::{COORDINATE_LIMIT, PedestrianName, PedestrianNames, Position};
use serde::{Deserialize, Serialize};
use thiserror::Error;

use crate::observation::Observation;
use crate::recording::Recording;

const SIZE: usize = 3;

/// The homography of a ground plane seen by a camera: the matrix that maps pixels to metres.
///
/// The matrix H maps a pixel (u, v), column and row, to the place (X / W, Y / W), where (X, Y, W) = H (u, v, 1), as
/// with `OpenCV`'s `findHomography(pixels, metres)`. The `H.txt` of the ETH recordings uses (row, column): swap its
/// first two columns.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "[[f64; SIZE]; SIZE]")]
pub struct Homography([[f64; SIZE]; SIZE]);

impl TryFrom<[[f64; SIZE]; SIZE]> for Homography {
    type Error = HomographyError;

    /// The matrix, row by row. Fails where an entry is not finite, or the matrix is singular.
    fn try_from(rows: [[f64; SIZE]; SIZE]) -> Result<Self, HomographyError> {
        for (row, entries) in rows.iter().enumerate() {
            if let Some(column) = entries.iter().position(|entry| !entry.is_finite()) {
                return Err(HomographyError::NotFinite { row, column });
            }
        }
        // Relative to the size of the rows, whose scale is arbitrary.
        let length = |row: &[f64; SIZE]| row.iter().map(|x| x * x).sum::<f64>().sqrt();
        let volume = determinant(&rows) / rows.iter().map(length).product::<f64>();
        // False for NaN.
        if volume.abs() > f64::EPSILON { Ok(Self(rows)) } else { Err(HomographyError::Singular) }
    }
}

impl Homography {
    /// The place of a pixel on the ground (m). `None` on the horizon, and near it where the place would be farther away
    /// than [`COORDINATE_LIMIT`].
    #[must_use]
    pub fn apply(&self, [u, v]: [f64; 2]) -> Option<Position> {
        let [x, y, w] = self.0.map(|[a, b, c]| a * u + b * v + c);
        let place = [x / w, y / w];
        // False for NaN.
        place.iter().all(|c| c.abs() <= COORDINATE_LIMIT).then_some(place)
    }

    /// The place on the ground (m) of a pedestrian seen at a pixel. The frame and the pedestrian are named in the
    /// error.
    ///
    /// # Errors
    /// [`HomographyError::Horizon`] where the pixel has no place on the ground.
    pub fn place(&self, seen: &Observation, names: &PedestrianNames) -> Result<Position, HomographyError> {
        let horizon = || HomographyError::Horizon {
            pedestrian: names.of(seen.pedestrian),
            frame: seen.frame,
            pixel: seen.position,
        };
        self.apply(seen.position).ok_or_else(horizon)
    }

    /// Converts a recording from pixels to metres.
    ///
    /// # Errors
    /// [`HomographyError::Horizon`] where a pixel has no place on the ground.
    pub fn to_ground(&self, recording: &Recording) -> Result<Recording, HomographyError> {
        let mut mapped = recording.clone();
        for seen in &mut mapped.observations {
            seen.position = self.place(seen, recording.names())?;
        }
        Ok(mapped)
    }
}

fn determinant([[a, b, c], [d, e, f], [g, h, i]]: &[[f64; SIZE]; SIZE]) -> f64 {
    a * (e * i - f * h) - b * (d * i - f * g) + c * (d * h - e * g)
}

impl std::str::FromStr for Homography {
    type Err = HomographyError;

    /// Nine numbers, three per line, separated by blanks or commas.
    fn from_str(text: &str) -> Result<Self, HomographyError> {
        let mut rows = [[0.0; SIZE]; SIZE];
        let mut count = 0;
        for (index, line) in text.lines().enumerate() {
            let fields: Vec<&str> = line.split([' ', '\t', ',']).filter(|field| !field.trim().is_empty()).collect();
            if fields.is_empty() {
                continue;
            }
            let wrong = || HomographyError::Line { line: index + 1, found: line.chars().take(60).collect() };
            let row = rows.get_mut(count).ok_or_else(wrong)?;
            if fields.len() != SIZE {
                return Err(wrong());
            }
            for (entry, field) in row.iter_mut().zip(fields) {
                *entry = field.trim().parse().map_err(|_| wrong())?;
            }
            count += 1;
        }
        if count < SIZE {
            return Err(HomographyError::Rows { found: count });
        }
        rows.try_into()
    }
}

/// A matrix that is not a [`Homography`], or a pixel without a place on the ground.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
#[expect(missing_docs, reason = "the messages say what the fields are")]
pub enum HomographyError {
    #[error("row {}, column {} of the homography is not finite", .row + 1, .column + 1)]
    NotFinite { row: usize, column: usize },
    #[error("the homography is singular: it maps the plane to a line; is a row repeated?")]
    Singular,
    #[error("line {line} of the homography must hold three numbers and be one of three lines, found {found:?}")]
    Line { line: usize, found: String },
    #[error("a homography has three rows of three numbers, found {found}")]
    Rows { found: usize },
    #[error(
        "pedestrian {pedestrian}, frame {frame}: pixel {pixel:?} lies on the horizon of the homography; does it \
         belong to this camera, and map pixels to metres?"
    )]
    Horizon { pedestrian: PedestrianName, frame: i64, pixel: [f64; 2] },
}
