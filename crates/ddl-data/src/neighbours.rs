//! Who is near whom: the neighbourhood that a forecast may look at.

use crate::Position;

/// Half the side of the box in which STAR and DDL look for neighbours (m).
pub const NEIGHBOUR_HALF_WIDTH: f64 = 10.0;

/// Which of N pedestrians are neighbours of which: a symmetric N x N relation without the diagonal. Indices out of range panic.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct NeighbourMask {
    count: usize,
    /// Row-major N x N.
    near: Vec<bool>,
}

impl NeighbourMask {
    /// i and j are neighbours if i != j, |dx| <= w and |dy| <= w, w being the half width (m).
    ///
    /// The box is aligned with the axes: as in the published code, neighbours are found before a scene is rotated.
    #[must_use]
    pub fn within_box(positions: &[Position], half_width_m: f64) -> Self {
        let count = positions.len();
        let mut near = Vec::with_capacity(count * count);
        for (i, a) in positions.iter().enumerate() {
            near.extend(positions.iter().enumerate().map(|(j, b)| {
                i != j && (a[0] - b[0]).abs() <= half_width_m && (a[1] - b[1]).abs() <= half_width_m
            }));
        }
        Self { count, near }
    }

    /// Number of pedestrians N.
    pub fn len(&self) -> usize {
        self.count
    }

    /// Whether there are no pedestrians.
    pub fn is_empty(&self) -> bool {
        self.count == 0
    }

    /// Whether j is a neighbour of i.
    pub fn is_neighbour(&self, i: usize, j: usize) -> bool {
        self.row(i)[j]
    }

    /// The relation of i to everybody, N values.
    pub fn row(&self, i: usize) -> &[bool] {
        &self.near[i * self.count..(i + 1) * self.count]
    }

    /// Every ordered pair (i, j) of neighbours: two pedestrians close to each other make two pairs.
    pub fn pairs(&self) -> impl Iterator<Item = (usize, usize)> + '_ {
        self.near
            .iter()
            .enumerate()
            .filter(|&(_, &near)| near)
            .map(|(index, _)| (index / self.count, index % self.count))
    }
}
