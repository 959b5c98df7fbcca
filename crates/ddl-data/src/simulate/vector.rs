//! Plane geometry for the simulation, on `[x, y]` arrays.

use ddl_core::Position;

pub(super) fn add(a: Position, b: Position) -> Position {
    [a[0] + b[0], a[1] + b[1]]
}

pub(super) fn sub(a: Position, b: Position) -> Position {
    [a[0] - b[0], a[1] - b[1]]
}

pub(super) fn scale(a: Position, factor: f64) -> Position {
    [a[0] * factor, a[1] * factor]
}

pub(super) fn dot(a: Position, b: Position) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

/// The z component of the cross product: positive if `b` lies to the left of `a`.
pub(super) fn cross(a: Position, b: Position) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}

pub(super) fn norm(a: Position) -> f64 {
    a[0].hypot(a[1])
}

/// The unit vector along `a`; zero if `a` is zero.
pub(super) fn unit(a: Position) -> Position {
    let length = norm(a);
    if length > 0.0 { scale(a, 1.0 / length) } else { [0.0, 0.0] }
}

/// `a` turned by 90 degrees counter-clockwise.
pub(super) fn left(a: Position) -> Position {
    [-a[1], a[0]]
}
