//! Obstacles of simulated scenes: walls and pillars.

use ddl_core::Position;

#[cfg(test)]
use crate::simulate::vector::cross;
use crate::simulate::vector::{add, dot, norm, scale, sub, unit};

/// A straight wall between two points, without thickness.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Wall {
    /// One end (m).
    pub(crate) from: Position,
    /// The other end (m).
    pub(crate) to: Position,
}

/// A round obstacle: a pillar, a tree, a fountain.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Pillar {
    /// Its centre (m).
    pub(crate) centre: Position,
    /// Its radius (m).
    pub(crate) radius: f64,
}

impl Wall {
    /// A wall between two points (m).
    pub(crate) const fn new(from: Position, to: Position) -> Self {
        Self { from, to }
    }

    /// The point of the wall nearest to `p` (m).
    pub(crate) fn nearest(&self, p: Position) -> Position {
        let along = sub(self.to, self.from);
        let length_squared = dot(along, along);
        if length_squared == 0.0 {
            return self.from;
        }
        let share = (dot(sub(p, self.from), along) / length_squared).clamp(0.0, 1.0);
        add(self.from, scale(along, share))
    }

    /// Whether the straight line from `a` to `b` (m) crosses the wall.
    #[cfg(test)]
    pub(crate) fn blocks(&self, a: Position, b: Position) -> bool {
        let (way, wall) = (sub(b, a), sub(self.to, self.from));
        let side = |p| cross(wall, sub(p, self.from));
        let other = |p| cross(way, sub(p, a));
        side(a) * side(b) < 0.0 && other(self.from) * other(self.to) < 0.0
    }

    /// `p`, moved out of the wall far enough for a body of this radius.
    pub(super) fn push_out(&self, p: Position, body: f64) -> Position {
        push_away(p, self.nearest(p), body)
    }
}

impl Pillar {
    /// A pillar with its centre and radius (m).
    pub(crate) const fn new(centre: Position, radius: f64) -> Self {
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_wall_blocks_what_crosses_it_and_nothing_else() {
        let wall = Wall::new([0.0, 0.0], [2.0, 0.0]);
        assert!(wall.blocks([1.0, -1.0], [1.0, 1.0]));
        assert!(!wall.blocks([3.0, -1.0], [3.0, 1.0]));
        assert!(!wall.blocks([1.0, 0.1], [1.0, 1.0]));
        // A line that only touches the wall or its end is not blocked.
        assert!(!wall.blocks([1.0, -1.0], [1.0, 0.0]));
        assert!(!wall.blocks([2.0, 1.0], [2.0, -1.0]));
    }
}
