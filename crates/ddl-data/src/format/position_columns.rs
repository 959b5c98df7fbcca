//! The columns of a position, and the position in them.

use ddl_core::{Position, Setting};

use crate::format::place::{FilePlace, Misread};

/// What a size of 0 may be wrong by.
const ROUNDING: f64 = 1e-6;

/// The columns of a position.
#[derive(Debug, Clone, Copy)]
pub(super) enum Place {
    Point([usize; 2]),
    /// The centre of a box: left, top, right, bottom.
    Centre([usize; 4]),
    /// The middle of the lower edge of a box: left, top, width, height.
    Foot([usize; 4]),
    /// The same of a box: left, top, right, bottom.
    FootOfCorners([usize; 4]),
}

impl Place {
    pub(super) fn columns(&self) -> &[usize] {
        match self {
            Self::Point(columns) => columns,
            Self::Centre(columns) | Self::Foot(columns) | Self::FootOfCorners(columns) => columns,
        }
    }

    /// The position in the row of a line, from the numbers in its columns.
    ///
    /// # Errors
    /// That of the first number, or if a box ends before it begins.
    pub(super) fn position(
        self,
        number: impl Fn(usize) -> Result<f64, Misread>,
        line: usize,
    ) -> Result<Position, Misread> {
        let columns = match self {
            Self::Point([x, y]) => return Ok([number(x)?, number(y)?]),
            Self::Centre(columns) | Self::Foot(columns) | Self::FootOfCorners(columns) => columns,
        };
        let [left, top, third, fourth] = columns.map(number);
        let [left, top, third, fourth] = [left?, top?, third?, fourth?];
        let (size, position) = match self {
            Self::Foot(_) => ([third, fourth], [left + 0.5 * third, top + fourth]),
            Self::Centre(_) => ([third - left, fourth - top], [0.5 * (left + third), 0.5 * (top + fourth)]),
            _ => ([third - left, fourth - top], [0.5 * (left + third), fourth]),
        };
        let is_backward = size.map(|side| side < -ROUNDING);
        // Corners may have any order along one axis, such as y upwards.
        let is_wrong = match self {
            Self::Foot(_) => is_backward.contains(&true),
            _ => !is_backward.contains(&false),
        };
        if is_wrong {
            let example = Setting::Columns.to("left=NAME,width=NAME,...");
            let problem = format!(
                "the box ends before it begins; leave out rows without a box, or say which columns are which ({example})"
            );
            let side = usize::from(!is_backward[0]);
            return Err(FilePlace::field(line, columns[2 + side] + 1).wrong(problem));
        }
        Ok(position)
    }
}
