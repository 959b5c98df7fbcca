//! Lloyd's iteration: each point to its nearest centre, each centre to the mean of its points.

use crate::points::{Points, squared_distance};

/// One run of Lloyd's iteration.
#[derive(Debug)]
pub(crate) struct Run {
    pub(crate) centres: Vec<[f64; 2]>,
    pub(crate) labels: Vec<u64>,
    /// Squared distance of each point to its centre.
    nearest: Vec<f64>,
    pub(crate) inertia: f64,
}

impl Run {
    /// Each point with the nearest of the given centres.
    pub(crate) fn from_centres(points: &Points, centres: Vec<[f64; 2]>) -> Self {
        let count = points.len();
        let mut run = Self {
            centres,
            labels: vec![0; count],
            nearest: vec![0.0; count],
            inertia: 0.0,
        };
        run.assign(points);
        run
    }

    /// The points themselves as centres, the first of them again until there are `clusters`.
    pub(crate) fn repeated(points: &Points, clusters: usize) -> Self {
        let centres = (0..clusters)
            .map(|k| points.get(k % points.len()))
            .collect();
        Self::from_centres(points, centres)
    }

    /// Moves the centres until no point changes its cluster, the centres move by `enough` or less (sum of squared
    /// distances), or `max_iterations` have passed.
    pub(crate) fn iterate(&mut self, points: &Points, max_iterations: usize, enough: f64) {
        for _ in 0..max_iterations {
            let moved = self.move_centres(points);
            let changed = self.assign(points);
            if !changed || moved <= enough {
                break;
            }
        }
    }

    /// Gives each point to its nearest centre, the first of equally near ones; whether any point changed its cluster.
    fn assign(&mut self, points: &Points) -> bool {
        // The loop over the points is the inner one: it has no branches and becomes vector instructions.
        let mut labels = vec![0_u64; points.len()];
        self.nearest.fill(f64::INFINITY);
        for (k, &centre) in self.centres.iter().enumerate() {
            let k = k as u64;
            let positions = points.x.iter().zip(&points.y);
            let cells = self.nearest.iter_mut().zip(labels.iter_mut());
            for ((nearest, label), (&x, &y)) in cells.zip(positions) {
                let distance = squared_distance([x, y], centre);
                let nearer = distance < *nearest;
                *nearest = if nearer { distance } else { *nearest };
                *label = if nearer { k } else { *label };
            }
        }
        self.inertia = self
            .nearest
            .iter()
            .zip(&points.weight)
            .map(|(d, w)| d * w)
            .sum();
        let changed = labels != self.labels;
        self.labels = labels;
        changed
    }

    /// Moves each centre to the mean of its points; the sum of the squared distances moved.
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

    /// Gives each empty cluster the point farthest from its own centre.
    fn fill_empty(&mut self, points: &Points) {
        let mut sizes = vec![0_usize; self.centres.len()];
        for &label in &self.labels {
            sizes[label as usize] += 1;
        }
        for empty in (0..sizes.len()).filter(|&k| sizes[k] == 0) {
            let farthest = (0..points.len())
                .filter(|&i| self.nearest[i] > 0.0)
                .max_by(|&a, &b| self.nearest[a].total_cmp(&self.nearest[b]));
            if let Some(index) = farthest {
                self.labels[index] = empty as u64;
                self.nearest[index] = 0.0;
            }
        }
    }
}
