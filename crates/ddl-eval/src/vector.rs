//! Differences of positions.

use ddl_data::Position;

/// The way from `b` to `a`.
pub(crate) fn minus(a: Position, b: Position) -> Position {
    [a[0] - b[0], a[1] - b[1]]
}

/// Angle from one direction to another, degrees; positive to the left, from x to y.
pub(crate) fn turn(from: Position, to: Position) -> f64 {
    let (cross, dot) = (
        from[0] * to[1] - from[1] * to[0],
        from[0] * to[0] + from[1] * to[1],
    );
    cross.atan2(dot).to_degrees()
}
