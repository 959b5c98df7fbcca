//! k-means of a few hundred points in the plane.

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

use crate::error::KMeansError;
use crate::lloyd::Run;
use crate::points::{Points, is_in_range};
use crate::seeding::first_centres;

/// k-means with greedy k-means++ seeding, Lloyd's iteration and restarts, of which the one of least inertia counts.
///
/// Inertia is the sum of the squared distances of the points to their centres (m²). A run ends when no point changes its
/// cluster, when the centres together move less than `tolerance` times the mean variance of the coordinates (squared
/// distances), or after `max_iterations`: the rules and the defaults (1e-4, 300) of scikit-learn. A cluster that loses all
/// its points is moved to the point farthest from its own centre.
///
/// Equal points count as one with a multiplicity. Where there are fewer distinct points than clusters, each is a centre
/// and the first of them are repeated until there are enough: always exactly as many centres as asked.
///
/// The result depends on the set of points and the seed, not on the order of the points. Every call draws the same random
/// numbers, so that points moved by a rounding error give centres moved by as much, short of ties.
///
/// # Examples
/// ```
/// use ddl_goal::KMeans;
/// let points = [[0.0, 0.0], [0.0, 1.0], [9.0, 0.0], [9.0, 1.0]];
/// let clustering = KMeans::new(2).fit(&points, 1)?;
/// assert_eq!(clustering.inertia(), 1.0);
/// assert_eq!(clustering.labels()[0], clustering.labels()[1]);
/// # Ok::<(), ddl_goal::KMeansError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct KMeans {
    clusters: usize,
    restarts: usize,
    max_iterations: usize,
    tolerance: f64,
}

/// What [`KMeans::fit`] found.
#[derive(Clone, Debug, PartialEq)]
pub struct Clustering {
    centres: Vec<[f64; 2]>,
    labels: Vec<usize>,
    inertia: f64,
}

impl Clustering {
    /// The centres (m), exactly as many as clusters were asked for.
    pub fn centres(&self) -> &[[f64; 2]] {
        &self.centres
    }

    /// For each point the index of its nearest centre (the first of equally near ones).
    pub fn labels(&self) -> &[usize] {
        &self.labels
    }

    /// Sum of the squared distances of the points to their centres (m²).
    pub fn inertia(&self) -> f64 {
        self.inertia
    }

    /// Number of points of each cluster; 0 for the second and later of equal centres.
    pub fn sizes(&self) -> Vec<usize> {
        let mut sizes = vec![0; self.centres.len()];
        for &label in &self.labels {
            sizes[label] += 1;
        }
        sizes
    }
}

impl KMeans {
    /// k-means with `clusters` clusters, 10 restarts, at most 300 iterations, tolerance 1e-4.
    #[must_use]
    pub fn new(clusters: usize) -> Self {
        Self {
            clusters,
            restarts: 10,
            max_iterations: 300,
            tolerance: 1e-4,
        }
    }

    /// Number of runs.
    #[must_use]
    pub fn restarts(mut self, restarts: usize) -> Self {
        self.restarts = restarts;
        self
    }

    /// Largest number of iterations of a run.
    #[must_use]
    pub fn max_iterations(mut self, max_iterations: usize) -> Self {
        self.max_iterations = max_iterations;
        self
    }

    /// Squared movement of all centres, relative to the mean variance of the coordinates, at which a run ends.
    #[must_use]
    pub fn tolerance(mut self, tolerance: f64) -> Self {
        self.tolerance = tolerance;
        self
    }

    /// Clusters `points` (m) with the random numbers of `seed`.
    ///
    /// # Errors
    /// No points, a point that is not finite or beyond 1e150, or a parameter that makes no sense.
    pub fn fit(&self, points: &[[f64; 2]], seed: u64) -> Result<Clustering, KMeansError> {
        self.check(points)?;
        let (distinct, place) = Points::distinct(points);
        let run = if distinct.len() <= self.clusters {
            let places = (0..distinct.len()).map(|index| distinct.get(index));
            Run::from_centres(&distinct, places.cycle().take(self.clusters).collect())
        } else {
            let mut rng = ChaCha8Rng::seed_from_u64(seed);
            let runs = (0..self.restarts).map(|_| self.run(&distinct, &mut rng));
            runs.min_by(|a, b| a.inertia.total_cmp(&b.inertia))
                .ok_or(KMeansError::NoRestarts)?
        };
        let labels = place
            .iter()
            .map(|&place| run.labels[place] as usize)
            .collect();
        Ok(Clustering {
            centres: run.centres,
            labels,
            inertia: run.inertia,
        })
    }

    fn check(&self, points: &[[f64; 2]]) -> Result<(), KMeansError> {
        if self.clusters == 0 {
            return Err(KMeansError::NoClusters);
        }
        if self.restarts == 0 {
            return Err(KMeansError::NoRestarts);
        }
        if !(self.tolerance.is_finite() && self.tolerance >= 0.0) {
            return Err(KMeansError::InvalidTolerance {
                tolerance: self.tolerance,
            });
        }
        if points.is_empty() {
            return Err(KMeansError::NoPoints);
        }
        match points.iter().position(|&point| !is_in_range(point)) {
            Some(index) => {
                let [x, y] = points[index];
                Err(KMeansError::OutOfRange { index, x, y })
            }
            None => Ok(()),
        }
    }

    fn run(&self, points: &Points, rng: &mut ChaCha8Rng) -> Run {
        let mut run = Run::from_centres(points, first_centres(points, self.clusters, rng));
        run.iterate(
            points,
            self.max_iterations,
            self.tolerance * points.mean_variance(),
        );
        run
    }
}
