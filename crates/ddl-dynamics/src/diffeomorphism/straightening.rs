//! A chain of local translations that straightens a demonstrated path.

mod fit;
mod unbending;

use nalgebra::SVector;

use super::{Chain, Diffeomorphism, LocalTranslation};
use crate::{error::DynamicsError, polar::polar, real::Real};
use fit::{FASTEST_RATE, Fit};
use unbending::Unbending;

const SAMPLES: usize = 64;

/// Number of points, at the spacing of the samples, by which a path is continued straight at each end. Without them an
/// end is fitted from one side only and gets a wrong direction.
const CONTINUATION: usize = 6;

/// Smallest distance of a continuation from another part of the path, in units of the sample spacing.
const CLEARANCE: f64 = 1.25;

/// Share of the layers that fit the intermediate shapes of the path while it unbends; the others reduce the remaining
/// residual.
const FOLLOWING: f64 = 0.75;

/// A chain that straightens a path, with its residuals: the result of [`Chain::straightening`].
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Straightening<T, const D: usize> {
    /// The map `psi`.
    pub chain: Chain<T, D>,
    /// 64 points of the path, evenly spaced along it (metres).
    pub samples: Vec<SVector<T, D>>,
    /// The target of each sample: on a straight line, at the spacing of the samples (metres).
    pub targets: Vec<SVector<T, D>>,
    /// Mean of `|psi(sample) - target|` (metres).
    pub mean_residual: T,
    /// Largest `|psi(sample) - target|` (metres).
    pub largest_residual: T,
}

impl<T: Real, const D: usize> Chain<T, D> {
    /// Fits a chain of at most `layers` [local translations](LocalTranslation) that maps `path`, a polygon from a start
    /// to a goal, to a straight line of the same length.
    ///
    /// The distance of two points along the path becomes the distance of their images. So a flow follows the path if it
    /// descends the potential `V(x) = |psi(x) - psi(p*)|` on straight lines in the image.
    ///
    /// # Method
    /// The path is unbent like a wire. Over the first three quarters of the layers, all its turns are scaled by a
    /// factor that goes from 1 to 0. The sides keep their lengths, and each shape is aligned to the previous one. Each
    /// layer moves the images of the points nearer to the current shape. Its candidates are centred at these images,
    /// with 26 rates between 0.3 and 40 per length of the path. The translation of each candidate is the least-squares
    /// solution, shortened to a [contraction](LocalTranslation::contraction) of at most 1/2. The candidate that lowers
    /// the sum of squared residuals most is taken. At both ends the path is continued straight for a tenth of its
    /// length, or until it would meet another part of itself.
    ///
    /// # Guarantees and limits
    /// The chain is a diffeomorphism for every path. The straightness of the image is reported, but not guaranteed: a
    /// path that crosses itself, or would cross itself while it unbends, cannot be straightened in this way. The same
    /// path gives the same chain.
    ///
    /// # Numerics
    /// Computed in `f64` for both number types, relative to the start and in units of the length of the path.
    ///
    /// # Errors
    /// - [`DynamicsError::NonFinite`]: a component of a point, which the error names.
    /// - [`DynamicsError::InvalidPathLength`]: fewer than two different points, or points so far apart or so close that
    ///   the parameters of the layers do not fit into `T`.
    /// - [`DynamicsError::PathTurnsBack`]: the path turns by 180 degrees at a point.
    ///
    /// # References
    /// N. Perrin, P. Schlehuber-Caissier, "Fast diffeomorphic matching to learn globally asymptotically stable
    /// nonlinear dynamical systems", Systems & Control Letters 96 (2016). R. L. Bishop, "There is more than one way to
    /// frame a curve", American Mathematical Monthly 82 (1975). W. Kabsch, "A solution for the best rotation to relate
    /// two sets of vectors", Acta Crystallographica A 32 (1976).
    pub fn straightening(path: &[SVector<T, D>], layers: usize) -> Result<Straightening<T, D>, DynamicsError> {
        ensure_finite_path(path)?;
        let path: Vec<_> = path.iter().map(|point| point.map(T::as_f64)).collect();
        let length = length(&path);
        let Some(origin) = path.first().filter(|start| fits::<T, D>(start, length)) else {
            return Err(DynamicsError::InvalidPathLength {
                points: path.len(),
                length,
            });
        };
        let samples = resampled(&path, length);
        let (continued, before) = continued(&samples);
        let unbending = Unbending::new(&continued).map_err(|point| {
            let sample = point.saturating_sub(before).min(SAMPLES - 1);
            DynamicsError::PathTurnsBack {
                along: length * sample as f64 / (SAMPLES - 1) as f64,
            }
        })?;

        let outside = |point: &SVector<f64, D>| (origin + point * length).map(T::rounded);
        let mut shape = continued.clone();
        let mut fit = Fit { images: continued };
        let mut chain = Vec::new();
        for layer in 0..layers {
            let unbent = (layer + 1) as f64 / (FOLLOWING * layers as f64);
            shape = unbending.placed((1.0 - unbent).max(0.0), &shape);
            if let Some(bump) = fit.best(&shape) {
                fit.push(&bump);
                chain.push(LocalTranslation::new(
                    outside(&bump.centre),
                    T::rounded(bump.rate / length),
                    (bump.translation * length).map(T::rounded),
                )?);
            }
        }
        shape = unbending.placed(0.0, &shape);
        Ok(Straightening::new(
            Self::new(chain),
            samples.iter().map(outside).collect(),
            shape[before..before + SAMPLES].iter().map(outside).collect(),
        ))
    }
}

impl<T: Real, const D: usize> Straightening<T, D> {
    fn new(chain: Chain<T, D>, samples: Vec<SVector<T, D>>, targets: Vec<SVector<T, D>>) -> Self {
        let residuals: Vec<T> = samples
            .iter()
            .zip(&targets)
            .map(|(sample, target)| polar(&(chain.apply(sample) - target)).0)
            .collect();
        let count = T::rounded(SAMPLES as f64);
        Self {
            chain,
            samples,
            targets,
            // Divided first: the sum may overflow although the mean does not.
            mean_residual: residuals.iter().fold(T::zero(), |sum, r| sum + *r / count),
            largest_residual: residuals.iter().fold(T::zero(), |most, r| most.max(*r)),
        }
    }
}

fn ensure_finite_path<T: Real, const D: usize>(path: &[SVector<T, D>]) -> Result<(), DynamicsError> {
    for (point, position) in path.iter().enumerate() {
        if let Some(component) = position.iter().position(|x| !x.is_finite()) {
            return Err(DynamicsError::NonFinite {
                entry: format!("component {component} of point {point} of the path"),
                value: position[component].as_f64(),
            });
        }
    }
    Ok(())
}

/// Length of a path; infinite if it or a difference of coordinates is too large for `f64`.
fn length<const D: usize>(path: &[SVector<f64, D>]) -> f64 {
    let sides = path.windows(2).map(|pair| polar(&(pair[1] - pair[0])).0);
    let length = sides.fold(0.0, |sum: f64, side| sum + side);
    if length.is_nan() { f64::INFINITY } else { length }
}

/// Whether the layers of a path from `start` fit into `T`: images stay within a few path lengths.
fn fits<T: Real, const D: usize>(start: &SVector<f64, D>, length: f64) -> bool {
    let reach = 16.0 * length + 16.0 * start.amax();
    length > 0.0 && T::rounded(reach).is_finite() && T::rounded(FASTEST_RATE / length).is_finite()
}

/// [`SAMPLES`] points, evenly spaced along `path`, from its start and in units of its `length`.
fn resampled<const D: usize>(path: &[SVector<f64, D>], length: f64) -> Vec<SVector<f64, D>> {
    let start = path[0];
    let mut samples = vec![SVector::zeros()];
    let mut walked = 0.0;
    for pair in path.windows(2) {
        let (side, direction) = polar(&(pair[1] - pair[0]));
        let from = (pair[0] - start) / length;
        while samples.len() < SAMPLES - 1 {
            let ahead = length * samples.len() as f64 / (SAMPLES - 1) as f64 - walked;
            if ahead > side {
                break;
            }
            samples.push(from + direction * (ahead / length));
        }
        walked += side;
    }
    // Due to rounding, the last samples may not be reached before the end; they are set to the end.
    let end = (path[path.len() - 1] - start) / length;
    samples.resize(SAMPLES, end);
    samples
}

/// The samples with straight continuations at both ends, and the number of points before the first sample.
fn continued<const D: usize>(samples: &[SVector<f64, D>]) -> (Vec<SVector<f64, D>>, usize) {
    let spacing = 1.0 / (SAMPLES - 1) as f64;
    let mut points = samples.to_vec();
    let mut lengths = [0, 0];
    for length in &mut lengths {
        points.reverse();
        let last = points.len() - 1;
        let (end, direction) = (points[last], polar(&(points[last] - points[last - 1])).1);
        for step in 1..=CONTINUATION {
            let point = end + direction * (step as f64 * spacing);
            let near = |p: &SVector<f64, D>| (p - point).norm() < CLEARANCE * spacing;
            if points[..last].iter().any(near) {
                break;
            }
            points.push(point);
            *length = step;
        }
    }
    (points, lengths[0])
}
