//! The heading frame: coordinates relative to a pedestrian's position and heading.

use crate::error::TrackError;
use crate::span::check_finite;

/// Length of the last step (m) below which it determines the heading only in part.
const SHORT_STEP: f64 = 0.2;
/// Length (m) below which a motion is attributed to rounding and has no direction.
const NEGLIGIBLE: f64 = 1e-6;

/// Coordinates of one pedestrian: the origin is its last observed position, the first axis points along its heading,
/// the second axis to its left.
///
/// With s the last step and l the displacement from the first to the last observed position, the heading is the
/// direction of
///
/// h = s + max(0, 1 − |s| / 0.2 m) l.
///
/// The heading is the direction of the last step; the shorter that step, the more the whole observation counts. If |h|
/// is below 1 µm, the pedestrian stands, and the frame has the axes of the world. Rotating or translating the scene
/// rotates or translates the frame with it; mirroring the scene changes the sign of the second coordinate.
///
/// # Examples
///
/// ```
/// use ddl_goal::HeadingFrame;
/// let frame = HeadingFrame::new(&[[2.0, 1.0], [2.0, 1.5], [2.0, 2.0]])?;
/// assert_eq!(frame.to_frame([2.0, 5.0]), [3.0, 0.0]); // 3 m ahead
/// assert_eq!(frame.to_frame([1.0, 2.0]), [0.0, 1.0]); // 1 m to the left
/// assert_eq!(frame.to_world([3.0, 0.0]), [2.0, 5.0]);
/// # Ok::<(), ddl_goal::TrackError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HeadingFrame {
    origin: [f64; 2],
    /// Unit vector of the heading in world coordinates: the first axis.
    pub(crate) heading: [f64; 2],
}

impl HeadingFrame {
    /// The frame of a pedestrian.
    ///
    /// # Shapes
    /// `observed`: at least 2 positions (m), all of which are read: pass no future positions.
    ///
    /// # Errors
    /// If there are fewer than 2 positions, one is not finite, or positions are so far apart that their difference is
    /// not finite.
    pub fn new(observed: &[[f64; 2]]) -> Result<Self, TrackError> {
        let [first, before, last] = match *observed {
            [first, last] => [first, first, last],
            [first, .., before, last] => [first, before, last],
            _ => {
                let positions = observed.len();
                return Err(TrackError::TooShort { positions, needed: 2 });
            }
        };
        check_finite(observed)?;
        let way = |from: [f64; 2]| [last[0] - from[0], last[1] - from[1]];
        let (step, whole) = (way(before), way(first));
        let share = (1.0 - step[0].hypot(step[1]) / SHORT_STEP).max(0.0);
        let toward = [step[0] + share * whole[0], step[1] + share * whole[1]];
        let length = toward[0].hypot(toward[1]);
        if !length.is_finite() {
            let index = observed.len() - 2;
            return Err(TrackError::VelocityOverflow { index });
        }
        let heading = if length < NEGLIGIBLE { [1.0, 0.0] } else { toward.map(|component| component / length) };
        Ok(Self { origin: last, heading })
    }

    /// Transforms a position from world coordinates (m) to this frame: metres ahead, metres to the left.
    pub fn to_frame(&self, point: [f64; 2]) -> [f64; 2] {
        self.turn_to_frame([point[0] - self.origin[0], point[1] - self.origin[1]])
    }

    /// Transforms a position from this frame (m) to world coordinates.
    pub fn to_world(&self, point: [f64; 2]) -> [f64; 2] {
        let [cos, sin] = self.heading;
        let [ahead, left] = point;
        [self.origin[0] + cos * ahead - sin * left, self.origin[1] + sin * ahead + cos * left]
    }

    /// Rotates a displacement or velocity from world coordinates to the axes of this frame.
    pub(crate) fn turn_to_frame(&self, vector: [f64; 2]) -> [f64; 2] {
        let [cos, sin] = self.heading;
        [cos * vector[0] + sin * vector[1], cos * vector[1] - sin * vector[0]]
    }
}
