//! Walls, gates and pillars of simulated scenes.

use ddl_core::{Position, between};

use crate::simulate::vector::{add, dot, left, norm, scale, sub, unit};

/// A straight line between two points (m): a wall without thickness, or a gate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Segment {
    pub(super) a: Position,
    pub(super) b: Position,
}

/// A round obstacle: a pillar, a tree, a fountain.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Pillar {
    /// Its centre (m).
    pub(super) centre: Position,
    /// Its radius (m).
    pub(super) radius: f64,
}

impl Segment {
    pub(super) const fn new(a: Position, b: Position) -> Self {
        Self { a, b }
    }

    pub(super) fn at(&self, share: f64) -> Position {
        between(self.a, self.b, share)
    }

    pub(super) fn width(&self) -> f64 {
        norm(sub(self.b, self.a))
    }

    /// The direction across the gate that leads away from `from`.
    pub(super) fn beyond(&self, from: Position) -> Position {
        let normal = left(unit(sub(self.b, self.a)));
        let ahead = dot(sub(self.at(0.5), from), normal);
        if ahead < 0.0 { scale(normal, -1.0) } else { normal }
    }

    /// The point of the line nearest to `p` (m).
    pub(super) fn nearest(&self, p: Position) -> Position {
        let along = sub(self.b, self.a);
        let length_squared = dot(along, along);
        if length_squared == 0.0 {
            return self.a;
        }
        add(self.a, scale(along, (dot(sub(p, self.a), along) / length_squared).clamp(0.0, 1.0)))
    }

    /// `p`, moved out of the wall far enough for a body of this radius.
    pub(super) fn push_out(&self, p: Position, body: f64) -> Position {
        push_away(p, self.nearest(p), body)
    }
}

impl Pillar {
    /// A pillar with its centre and radius (m).
    pub(super) const fn new(centre: Position, radius: f64) -> Self {
        Self { centre, radius }
    }

    pub(super) fn push_out(&self, p: Position, body: f64) -> Position {
        push_away(p, self.centre, self.radius + body)
    }
}

/// `p`, moved straight away from `point` to the given distance; unchanged if it is already that far.
fn push_away(p: Position, point: Position, distance: f64) -> Position {
    let away = sub(p, point);
    if norm(away) >= distance { p } else { add(point, scale(unit(away), distance)) }
}
