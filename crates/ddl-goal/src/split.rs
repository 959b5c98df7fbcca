//! Deterministic first centres: the cell with most to gain is cut in two until there are enough.

use crate::points::Points;

/// Points that get one centre together.
struct Cell {
    /// Indices of the points.
    members: Vec<usize>,
    mean: [f64; 2],
    /// Unit vector along which the points vary most.
    axis: [f64; 2],
    /// Weight times standard deviation: about the sum of the weighted distances to the mean.
    cost: f64,
}

/// Chooses `clusters` centres, or fewer where the points are at fewer places.
///
/// Starting with one cell that holds all points, the cell with the largest Σw · √(Σw d² / Σw) (w weight, d distance to
/// the weighted mean) is cut through its mean, across the axis along which it varies most. This cost is in metres, as the
/// mean distance of the nearest goal is. The centres are the means of the cells.
pub(crate) fn first_centres(points: &Points, clusters: usize) -> Vec<[f64; 2]> {
    let mut cells = vec![Cell::new(points, (0..points.len()).collect())];
    while cells.len() < clusters {
        let costliest = (0..cells.len())
            .filter(|&i| cells[i].cost > 0.0)
            .max_by(|&a, &b| cells[a].cost.total_cmp(&cells[b].cost).then(b.cmp(&a)));
        let Some(costliest) = costliest else { break };
        let Cell {
            members,
            mean,
            axis,
            ..
        } = &cells[costliest];
        let behind = |&index: &usize| {
            let [x, y] = points.get(index);
            (x - mean[0]) * axis[0] + (y - mean[1]) * axis[1] < 0.0
        };
        let (behind, ahead): (Vec<usize>, Vec<usize>) = members.iter().partition(|i| behind(i));
        if behind.is_empty() || ahead.is_empty() {
            cells[costliest].cost = 0.0; // only rounding is left to divide
        } else {
            cells[costliest] = Cell::new(points, behind);
            cells.push(Cell::new(points, ahead));
        }
    }
    cells.iter().map(|cell| cell.mean).collect()
}

impl Cell {
    fn new(points: &Points, members: Vec<usize>) -> Self {
        let (mut weight, mut sum) = (0.0, [0.0; 2]);
        for &index in &members {
            let w = points.weight[index];
            weight += w;
            sum = [sum[0] + w * points.x[index], sum[1] + w * points.y[index]];
        }
        let mean = sum.map(|sum| sum / weight);
        let (mut xx, mut xy, mut yy) = (0.0, 0.0, 0.0);
        for &index in &members {
            let w = points.weight[index];
            let (dx, dy) = (points.x[index] - mean[0], points.y[index] - mean[1]);
            xx += w * dx * dx;
            xy += w * dx * dy;
            yy += w * dy * dy;
        }
        let (sin, cos) = (0.5 * (2.0 * xy).atan2(xx - yy)).sin_cos();
        Self {
            members,
            mean,
            axis: [cos, sin],
            cost: (weight * (xx + yy)).sqrt(),
        }
    }
}
