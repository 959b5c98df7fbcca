//! The columns of a position, and the position in them.

use ddl_core::{Position, Setting};

use crate::format::fault::Fault;

/// What a size of 0 may be wrong by.
const ROUNDING: f64 = 1e-6;

/// The columns of a position.
#[derive(Debug, Clone, Copy)]
pub(super) enum PositionColumns {
    Point([usize; 2]),
    /// The centre of a box: left, top, right, bottom.
    Centre([usize; 4]),
    /// The middle of the lower edge of a box: left, top, width, height.
    Foot([usize; 4]),
    /// The same of a box: left, top, right, bottom.
    FootOfCorners([usize; 4]),
}

impl PositionColumns {
    pub(super) fn columns(&self) -> &[usize] {
        match self {
            Self::Point(columns) => columns,
            Self::Centre(columns) | Self::Foot(columns) | Self::FootOfCorners(columns) => columns,
        }
    }

    /// The position, from the numbers in its columns.
    ///
    /// # Errors
    /// That of the first number, or if a box ends before it begins.
    pub(super) fn position(self, number: impl Fn(usize) -> Result<f64, Fault>) -> Result<Position, Fault> {
        let columns = match self {
            Self::Point([x, y]) => return Ok([number(x)?, number(y)?]),
            Self::Centre(columns) | Self::Foot(columns) | Self::FootOfCorners(columns) => columns,
        };
        let [left, top, third, fourth] =
            [number(columns[0])?, number(columns[1])?, number(columns[2])?, number(columns[3])?];
        let corners = ([third - left, fourth - top], 0.5 * (left + third));
        let (size, position) = match self {
            Self::Foot(_) => ([third, fourth], [left + 0.5 * third, top + fourth]),
            Self::Centre(_) => (corners.0, [corners.1, 0.5 * (top + fourth)]),
            _ => (corners.0, [corners.1, fourth]),
        };
        let is_backward = size.map(|side| side < -ROUNDING);
        // Corners may have any order along one axis, such as y upwards.
        let most = usize::from(!matches!(self, Self::Foot(_)));
        if is_backward.iter().filter(|side| **side).count() <= most {
            return Ok(position);
        }
        let example = Setting::Columns.to("left=NAME,width=NAME,...");
        let advice = format!("leave out rows without a box, or say which columns are which ({example})");
        Err(Fault::at(columns[2 + usize::from(!is_backward[0])], format!("the box ends before it begins; {advice}")))
    }
}
