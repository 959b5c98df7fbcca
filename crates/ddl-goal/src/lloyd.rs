//! Lloyd's iteration: assign each point to its nearest centre, then move each centre to the mean of its points.

#![expect(clippy::inline_always, reason = "compiled per instruction set")]

use crate::points::{Points, squared_distance};
use ddl_simd::{Dispatch, Kernel, Simd};

#[derive(Debug)]
pub(crate) struct Lloyd {
    pub(crate) centres: Vec<[f64; 2]>,
    pub(crate) labels: Vec<u64>,
    nearest: Vec<f64>,
    pub(crate) inertia: f64,
}

impl Lloyd {
    pub(crate) fn from_centres(points: &Points, centres: Vec<[f64; 2]>) -> Self {
        let count = points.len();
        let mut run = Self { centres, labels: vec![0; count], nearest: vec![0.0; count], inertia: 0.0 };
        run.assign(points);
        run
    }

    /// Iterates until the centres move by `enough` or less (sum of squared distances), or for `max_iterations`. They
    /// move by 0 once no point changes its cluster.
    pub(crate) fn iterate(&mut self, points: &Points, max_iterations: usize, enough: f64) {
        for _ in 0..max_iterations {
            let moved = self.move_centres(points);
            self.assign(points);
            if moved <= enough {
                break;
            }
        }
    }

    /// Assigns each point to its nearest centre, the first of equally near ones.
    fn assign(&mut self, points: &Points) {
        Dispatch::detect().run(Assign {
            points,
            centres: &self.centres,
            labels: &mut self.labels,
            nearest: &mut self.nearest,
        });
        self.inertia = self.nearest.iter().zip(&points.weight).map(|(d, w)| d * w).sum();
    }

    fn move_centres(&mut self, points: &Points) -> f64 {
        self.fill_empty(points);
        let mut sums = vec![[0.0_f64; 3]; self.centres.len()];
        for (index, &label) in self.labels.iter().enumerate() {
            let weight = points.weight[index];
            let sum = &mut sums[label as usize];
            sum[0] += weight * points.x[index];
            sum[1] += weight * points.y[index];
            sum[2] += weight;
        }
        let mut moved = 0.0;
        for (centre, [x, y, weight]) in self.centres.iter_mut().zip(sums) {
            if weight > 0.0 {
                let mean = [x / weight, y / weight];
                moved += squared_distance(*centre, mean);
                *centre = mean;
            }
        }
        moved
    }

    fn fill_empty(&mut self, points: &Points) {
        let mut sizes = vec![0_usize; self.centres.len()];
        for &label in &self.labels {
            sizes[label as usize] += 1;
        }
        for empty in (0..sizes.len()).filter(|&k| sizes[k] == 0) {
            let farthest = (0..points.len()).max_by(|&a, &b| self.nearest[a].total_cmp(&self.nearest[b]));
            if let Some(index) = farthest {
                self.labels[index] = empty as u64;
                self.nearest[index] = 0.0;
            }
        }
    }
}

struct Assign<'a> {
    points: &'a Points,
    centres: &'a [[f64; 2]],
    labels: &'a mut [u64],
    nearest: &'a mut [f64],
}

impl Kernel for Assign<'_> {
    /// Plain loops, compiled for the instruction set; the result has the same bits for every instruction set.
    #[inline(always)]
    fn run<S: Simd>(self, _: S) {
        self.labels.fill(0);
        self.nearest.fill(f64::INFINITY);
        for (k, &centre) in self.centres.iter().enumerate() {
            let k = k as u64;
            let positions = self.points.x.iter().zip(&self.points.y);
            let cells = self.nearest.iter_mut().zip(self.labels.iter_mut());
            // The inner loop has no branches and is vectorised.
            for ((nearest, label), (&x, &y)) in cells.zip(positions) {
                let distance = squared_distance([x, y], centre);
                let nearer = distance < *nearest;
                *nearest = if nearer { distance } else { *nearest };
                *label = if nearer { k } else { *label };
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Lloyd;
    use crate::points::Points;

    /// By hand: no point is near the second centre, so it takes the point at 10, the farthest from its own centre. The
    /// first centre keeps the points 0 and 1, of weights 1 and 3.
    #[test]
    fn a_cluster_without_points_takes_the_farthest_point() {
        let mut points = Points::default();
        for (x, weight) in [(0.0, 1.0), (1.0, 3.0), (10.0, 1.0)] {
            points.push([x, 0.0], weight);
        }
        let mut run = Lloyd::from_centres(&points, vec![[0.5, 0.0], [100.0, 0.0]]);
        assert_eq!(run.labels, [0, 0, 0]);
        run.iterate(&points, 1, 0.0);
        assert_eq!(run.centres, [[0.75, 0.0], [10.0, 0.0]]);
        assert_eq!(run.labels, [0, 0, 1]);
        assert!((run.inertia - (0.75 * 0.75 + 3.0 * 0.25 * 0.25)).abs() < 1e-12);
    }
}
