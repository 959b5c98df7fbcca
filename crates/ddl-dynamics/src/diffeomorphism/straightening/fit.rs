//! Fit of the next local translation of a chain.

use nalgebra::SVector;

use crate::polar::polar;

const RATES: usize = 26;
const SLOWEST_RATE: f64 = 0.3;
pub(super) const FASTEST_RATE: f64 = 40.0;

/// Largest contraction of a layer; the map would allow more.
const CONTRACTION: f64 = 0.5;

/// A translation shorter than this share of the path length is omitted.
const NEGLIGIBLE: f64 = 1e-12;

/// A local translation in units of the length of the path.
pub(super) struct Bump<const D: usize> {
    pub(super) centre: SVector<f64, D>,
    pub(super) rate: f64,
    pub(super) translation: SVector<f64, D>,
}

pub(super) struct Fit<const D: usize> {
    pub(super) images: Vec<SVector<f64, D>>,
}

impl<const D: usize> Fit<D> {
    /// The translation that reduces the sum of squared distances from images to `targets` most.
    pub(super) fn best(&self, targets: &[SVector<f64, D>]) -> Option<Bump<D>> {
        let residuals: Vec<_> = targets.iter().zip(&self.images).map(|(y, x)| y - x).collect();
        let steepest = (2.0 / std::f64::consts::E).sqrt();
        let mut most = 0.0;
        let mut best = None;
        for step in 0..RATES {
            let exponent = step as f64 / (RATES - 1) as f64;
            let rate = SLOWEST_RATE * (FASTEST_RATE / SLOWEST_RATE).powf(exponent);
            let longest = CONTRACTION / (steepest * rate);
            for (centre, (sum, squares)) in self.images.iter().zip(self.sums(rate, &residuals)) {
                let (unlimited, direction) = polar(&(sum / squares));
                let length = unlimited.min(longest);
                // |r|^2 - |r - k v|^2, summed over the samples.
                let gain = length * (2.0 * direction.dot(&sum) - length * squares);
                if length > NEGLIGIBLE && gain > most {
                    most = gain;
                    best = Some(Bump {
                        centre: *centre,
                        rate,
                        translation: direction * length,
                    });
                }
            }
        }
        best
    }

    /// `sum k_i r_i` and `sum k_i^2` for bumps centred at each of the images.
    fn sums(&self, rate: f64, residuals: &[SVector<f64, D>]) -> Vec<(SVector<f64, D>, f64)> {
        // At its own centre a bump is 1.
        let mut sums: Vec<_> = residuals.iter().map(|r| (*r, 1.0)).collect();
        for i in 0..sums.len() {
            for j in 0..i {
                let offset = self.images[i] - self.images[j];
                let height = (-rate * rate * offset.norm_squared()).exp();
                sums[i].0 += residuals[j] * height;
                sums[j].0 += residuals[i] * height;
                sums[i].1 += height * height;
                sums[j].1 += height * height;
            }
        }
        sums
    }

    pub(super) fn push(&mut self, bump: &Bump<D>) {
        for image in &mut self.images {
            let offset = *image - bump.centre;
            let height = (-bump.rate * bump.rate * offset.norm_squared()).exp();
            *image += bump.translation * height;
        }
    }
}
