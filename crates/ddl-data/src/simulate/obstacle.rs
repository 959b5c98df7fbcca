//! Obstacles of simulated scenes: walls and pillars.

use ddl_core::Position;

use crate::simulate::vector::{add, dot, norm, scale, sub, unit};

/// A straight wall between two points, without thickness.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Wall {
    /// One end (m).
    pub(super) from: Position,
    /// The other end (m).
    pub(super) to: Position,
}

/// A round obstacle: a pillar, a tree, a fountain.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Pillar {
    /// Its centre (m).
    pub(super) centre: Position,
    /// Its radius (m).
    pub(super) radius: f64,
}

impl Wall {
    /// A wall between two points (m).
    pub(super) const fn new(from: Position, to: Position) -> Self {
        Self { from, to }
    }

    /// The point of the wall nearest to `p` (m).
    pub(super) fn nearest(&self, p: Position) -> Position {
        let along = sub(self.to, self.from);
        let length_squared = dot(along, along);
        if length_squared == 0.0 {
            return self.from;
        }
        let share = (dot(sub(p, self.from), along) / length_squared).clamp(0.0, 1.0);
        add(self.from, scale(along, share))
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
    if norm(away) >= distance {
        p
    } else {
        add(point, scale(unit(away), distance))
    }
}
