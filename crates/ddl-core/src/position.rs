//! Positions on the ground, and the sampling of windows in time.

/// A place on the ground plane, `[x, y]` in metres.
pub type Position = [f64; 2];

/// Seconds between two steps of a recording (s).
pub const TIME_STEP: f64 = 0.4;
/// Observed steps of a window (3.2 s).
pub const OBSERVED: usize = 8;
/// Steps to forecast (4.8 s).
pub const HORIZON: usize = 12;
/// Steps of a whole window: observed and to forecast.
pub const WINDOW: usize = OBSERVED + HORIZON;

/// Limit of frame numbers: exact in an `f64`, and far from overflow in sums.
pub const FRAME_LIMIT: i64 = 1 << 53;

/// Largest coordinate (m) accepted from files and streams; UTM coordinates reach 10,000 km.
pub const COORDINATE_LIMIT: f64 = 1e7;

/// Whether a raw frame number is below [`FRAME_LIMIT`] in size.
pub fn is_frame(frame: i64) -> bool {
    frame.unsigned_abs() < FRAME_LIMIT.unsigned_abs()
}

/// Whether a number of raw frames per step is in 1..=2^31.
pub fn is_frame_step(step: i64) -> bool {
    (1..=1 << 31).contains(&step)
}

/// Whether both coordinates are finite.
pub fn is_finite(position: Position) -> bool {
    position.iter().all(|coordinate| coordinate.is_finite())
}

/// The point at a share of the way from one position to another: 0 gives the first; above 1 lies beyond the second.
pub fn between(from: Position, to: Position, share: f64) -> Position {
    [0, 1].map(|axis| from[axis] + share * (to[axis] - from[axis]))
}

/// Least and largest x and y of positions, `[low, high]`; `None` without positions.
pub fn bounds(places: impl IntoIterator<Item = Position>) -> Option<[Position; 2]> {
    places.into_iter().fold(None, |bounds, place| {
        let [low, high] = bounds.unwrap_or([place; 2]);
        Some([[0, 1].map(|axis| low[axis].min(place[axis])), [0, 1].map(|axis| high[axis].max(place[axis]))])
    })
}

/// Euclidean distance of two positions (m).
pub fn distance(a: Position, b: Position) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}
