//! k-means of a few hundred points in the plane.

use crate::error::GoalError;
use crate::lloyd::Lloyd;
use crate::points::{Points, is_in_range};
use crate::seeding::first_centres;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

/// k-means with greedy k-means++ seeding, Lloyd's iteration and restarts. The run with the smallest inertia is used.
///
/// Inertia is the sum of the squared distances of the points to their centres (m²). A run ends when no point changes
/// its cluster, or when the sum of the squared movements of the centres is below `tolerance` times the mean variance of
/// the coordinates, or after `max_iterations`. These are the rules and defaults of scikit-learn. A cluster that loses
/// all its points is moved to the point farthest from its own centre. Equal points count as one with a multiplicity. If
/// there are fewer distinct points than clusters, each point is a centre and the first ones are repeated, so there are
/// always `clusters` centres. The result depends on the set of points and the seed, not on the order of the points.
#[derive(Clone, Debug)]
pub(crate) struct KMeans {
    pub(crate) clusters: usize,
    pub(crate) restarts: usize,
    pub(crate) max_iterations: usize,
    pub(crate) tolerance: f64,
}

#[derive(Debug)]
pub(crate) struct Clustering {
    /// Exactly as many centres as clusters requested (m).
    pub(crate) centres: Vec<[f64; 2]>,
    /// Index of the nearest centre of each point (the first of equally near ones).
    pub(crate) labels: Vec<usize>,
    /// Inertia of the best run (m²).
    #[cfg_attr(not(test), expect(dead_code, reason = "used by the tests"))]
    pub(crate) inertia: f64,
}

impl Clustering {
    /// Number of points of each cluster; 0 for the second and later of equal centres.
    pub(crate) fn sizes(&self) -> Vec<usize> {
        let mut sizes = vec![0; self.centres.len()];
        for &label in &self.labels {
            sizes[label] += 1;
        }
        sizes
    }
}

impl KMeans {
    /// k-means with at least one cluster and at least one restart; at most 300 iterations, tolerance 1e-4.
    pub(crate) fn new(clusters: usize, restarts: usize) -> Self {
        Self { clusters, restarts, max_iterations: 300, tolerance: 1e-4 }
    }

    /// Clusters `points` (m), at least one, with random numbers from `seed`.
    ///
    /// # Errors
    /// If a point is not finite or beyond 1e150.
    pub(crate) fn fit(&self, points: &[[f64; 2]], seed: u64) -> Result<Clustering, GoalError> {
        if let Some(index) = points.iter().position(|&point| !is_in_range(point)) {
            let [x, y] = points[index];
            return Err(GoalError::EndOutOfRange { index, x, y });
        }
        let (distinct, place) = Points::distinct(points);
        let run = if distinct.len() <= self.clusters {
            let places = (0..distinct.len()).map(|index| distinct.get(index));
            Lloyd::from_centres(&distinct, places.cycle().take(self.clusters).collect())
        } else {
            let mut rng = ChaCha8Rng::seed_from_u64(seed);
            let mut best = self.run(&distinct, &mut rng);
            for _ in 1..self.restarts {
                let run = self.run(&distinct, &mut rng);
                if run.inertia < best.inertia {
                    best = run;
                }
            }
            best
        };
        let labels = place.iter().map(|&place| run.labels[place] as usize);
        Ok(Clustering { labels: labels.collect(), centres: run.centres, inertia: run.inertia })
    }

    fn run(&self, points: &Points, rng: &mut ChaCha8Rng) -> Lloyd {
        let mut run = Lloyd::from_centres(points, first_centres(points, self.clusters, rng));
        let enough = self.tolerance * points.mean_variance();
        run.iterate(points, self.max_iterations, enough);
        run
    }
}

#[cfg(test)]
mod tests;
