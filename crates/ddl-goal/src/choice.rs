//! Choice of a few goals that represent many weighted points.

use crate::lloyd::Lloyd;
use crate::points::Points;

/// Chooses `clusters` goals such that the weighted mean distance of a point to its nearest goal is small. Cells are
/// divided in two, the costliest first; then `steps` of Lloyd's iteration follow. The result is deterministic. If there
/// are fewer distinct points than goals, goals are repeated with weight 0. Returned are the goals, and for each the
/// total weight of its nearest points.
pub(crate) fn choose(points: &Points, clusters: usize, steps: usize) -> (Vec<[f64; 2]>, Vec<f64>) {
    let centres = first_centres(points, clusters).into_iter().cycle();
    let mut run = Lloyd::from_centres(points, centres.take(clusters).collect());
    run.iterate(points, steps, 0.0);
    let mut weights = vec![0.0; clusters];
    for (&label, weight) in run.labels.iter().zip(&points.weight) {
        weights[label as usize] += weight;
    }
    (run.centres, weights)
}

struct Cell {
    members: Vec<usize>,
    mean: [f64; 2],
    /// Unit vector along which the points vary most.
    axis: [f64; 2],
    /// Weight times standard deviation: approximately the sum of the weighted distances to the mean.
    cost: f64,
}

/// Chooses `clusters` centres, or fewer if there are fewer distinct points. It starts with one cell that holds all
/// points. The cell with the largest Σw · √(Σw d² / Σw) (w weight, d distance to the weighted mean) is divided through
/// its mean, across its axis of largest variance. This cost is in metres, like the mean distance to the nearest goal.
/// The centres are the means of the cells.
fn first_centres(points: &Points, clusters: usize) -> Vec<[f64; 2]> {
    let mut cells = vec![Cell::new(points, (0..points.len()).collect())];
    while cells.len() < clusters {
        let costliest = (0..cells.len())
            .filter(|&i| cells[i].cost > 0.0)
            .max_by(|&a, &b| cells[a].cost.total_cmp(&cells[b].cost).then(b.cmp(&a)));
        let Some(costliest) = costliest else { break };
        let Cell { members, mean, axis, .. } = &cells[costliest];
        let is_behind = |index: usize| {
            let [x, y] = points.get(index);
            (x - mean[0]) * axis[0] + (y - mean[1]) * axis[1] < 0.0
        };
        let [behind, ahead] = parted(members, is_behind);
        if behind.is_empty() || ahead.is_empty() {
            cells[costliest].cost = 0.0; // only rounding differences remain
        } else {
            cells[costliest] = Cell::new(points, behind);
            cells.push(Cell::new(points, ahead));
        }
    }
    cells.iter().map(|cell| cell.mean).collect()
}

fn parted(members: &[usize], is_first: impl Fn(usize) -> bool) -> [Vec<usize>; 2] {
    let mut parts = [vec![0; members.len()], vec![0; members.len()]];
    let mut counts = [0; 2];
    for &index in members {
        // Each index is written to both lists and kept in one: this avoids an unpredictable branch.
        for (part, count) in parts.iter_mut().zip(counts) {
            part[count] = index;
        }
        counts[usize::from(!is_first(index))] += 1;
    }
    for (part, count) in parts.iter_mut().zip(counts) {
        part.truncate(count);
    }
    parts
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
        Self { members, mean, axis: [cos, sin], cost: (weight * (xx + yy)).sqrt() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::points::squared_distance;
    use proptest::prelude::*;

    fn weighted(points: &[([f64; 2], f64)]) -> Points {
        let mut weighted = Points::default();
        for &(point, weight) in points {
            weighted.push(point, weight);
        }
        weighted
    }

    fn cost(points: &Points, centres: &[[f64; 2]]) -> f64 {
        let nearest =
            |i: usize| centres.iter().map(|&c| squared_distance(c, points.get(i))).fold(f64::INFINITY, f64::min).sqrt();
        (0..points.len()).map(|i| points.weight[i] * nearest(i)).sum()
    }

    /// By hand: a point on the cut belongs to the front half. Two adjacent floating-point numbers have no mean between
    /// them and stay one cell.
    #[test]
    fn a_point_on_the_cut_is_in_front_and_an_indivisible_cell_stays() {
        let points = weighted(&[([-1.0, 0.0], 1.0), ([0.0, 0.0], 1.0), ([1.0, 0.0], 1.0)]);
        assert_eq!(first_centres(&points, 2), [[-1.0, 0.0], [0.5, 0.0]]);
        let next = 1.0 + f64::EPSILON;
        let points = weighted(&[([1.0, 0.0], 1.0), ([next, 0.0], 1.0)]);
        assert_eq!(first_centres(&points, 2), [[1.0, 0.0]]);
    }

    proptest! {
        #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

        #[test]
        fn evenly_spread_points_are_covered_well(count in 200..600_usize, clusters in 4..25_usize) {
            // The optimal arrangement of n centres in a unit square has a mean distance of about 0.377 / √n.
            let points: Vec<_> = (0..count)
                .map(|i| ([(i as f64 * 0.754_877_666).fract(), (i as f64 * 0.569_840_291).fract()], 1.0 / count as f64))
                .collect();
            let points = weighted(&points);
            let cost = cost(&points, &first_centres(&points, clusters));
            prop_assert!(cost * (clusters as f64).sqrt() < 0.377 * 1.3, "{} with {}", cost, clusters);
        }
    }
}
