//! A walk from its start to its goal.

use ddl_dynamics::Flow;
use nalgebra::Vector2;

/// Positions, and what the flow descends at each.
pub(crate) struct Walk {
    /// The start and the position after each step, to the first on the goal (metres).
    pub(crate) path: Vec<Vector2<f64>>,
    /// The potential of the flow at each position (metres).
    pub(crate) potentials: Vec<f64>,
    /// The distance to the goal at each position (metres).
    pub(crate) distances: Vec<f64>,
}

impl Walk {
    pub(crate) fn until_arrival(flow: &impl Flow<f64, 2>, mut path: Vec<Vector2<f64>>) -> Self {
        if let Some(steps) = path.iter().position(|p| p == flow.goal()) {
            path.truncate(steps + 1);
        }
        let image = |p: &Vector2<f64>| flow.chart().map_or(*p, |psi| psi.apply(p));
        let potential = |p: &Vector2<f64>| flow.attractor().potential(&image(p));
        Self {
            potentials: path.iter().map(potential).collect(),
            distances: path.iter().map(|p| (p - flow.goal()).norm()).collect(),
            path,
        }
    }

    pub(crate) fn steps(&self) -> usize {
        self.path.len().saturating_sub(1)
    }

    /// The step that leads away from the direction to `goal` most, and the angle between both
    /// (radians).
    pub(crate) fn largest_angle(&self, goal: &Vector2<f64>) -> (usize, f64) {
        let moves = self.path.windows(2).enumerate();
        let angles = moves.map(|(step, pair)| (step, (pair[1] - pair[0]).angle(&(goal - pair[0]))));
        let larger = |most: (usize, f64), next: (usize, f64)| {
            if next.1 > most.1 { next } else { most }
        };
        angles.fold((0, 0.0), larger)
    }
}

/// How many of the steps lower the number.
pub(crate) fn falls(numbers: &[f64]) -> usize {
    numbers.windows(2).filter(|pair| pair[1] < pair[0]).count()
}
