//! Constant velocity: every pedestrian keeps its velocity.

use ddl_core::{Forecast, ForecastError, Forecaster, HORIZON, OBSERVED, Position, Window};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

const SAMPLES: usize = 20;
/// Standard deviation of the noisy variant's angle, degrees.
const NOISE_DEG: f64 = 25.0;

/// Constant velocity: `p(8 + t) = p(8) + t v`, with v in metres per frame.
///
/// # References
/// Schoeller et al., "What the constant velocity model can teach us about pedestrian motion prediction", RA-L 2020.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ConstantVelocity {
    /// v is the last observed step, `p(8) - p(7)`.
    LastStep,
    /// v is the mean of the 7 observed steps, `(p(8) - p(1)) / 7`.
    MeanObserved,
    /// Twenty hypotheses of equal weight: the last observed step turned by angles drawn from N(0, (25 degrees)^2). They
    /// depend only on the seed, the recording and the first frame.
    AngularNoise {
        /// Seed of the draws.
        seed: u64,
    },
}

impl ConstantVelocity {
    fn velocity(self, observed: &[Position]) -> Position {
        let back = if self == Self::MeanObserved { OBSERVED - 1 } else { 1 };
        let (from, to) = (observed[OBSERVED - 1 - back], observed[OBSERVED - 1]);
        [(to[0] - from[0]) / back as f64, (to[1] - from[1]) / back as f64]
    }
}

impl Forecaster for ConstantVelocity {
    fn name(&self) -> String {
        match *self {
            Self::LastStep => "constant velocity (last step)".to_owned(),
            Self::MeanObserved => "constant velocity (mean observed)".to_owned(),
            Self::AngularNoise { .. } => {
                format!("constant velocity ({NOISE_DEG} degree angular noise)")
            }
        }
    }

    fn forecast(&self, window: &Window) -> Result<Forecast, ForecastError> {
        let (mut random, samples) = match *self {
            Self::AngularNoise { seed } => (Some(stream(seed, window)), SAMPLES),
            _ => (None, 1),
        };
        let mut positions = Vec::with_capacity(window.len() * samples * HORIZON);
        for i in 0..window.len() {
            let observed = window.observed(i);
            let (start, velocity) = (observed[OBSERVED - 1], self.velocity(observed));
            for _ in 0..samples {
                let angle = random.as_mut().map_or(0.0, |random| {
                    let normal: f64 = StandardNormal.sample(random);
                    (NOISE_DEG * normal).to_radians()
                });
                let (sin, cos) = angle.sin_cos();
                let v = [cos * velocity[0] - sin * velocity[1], sin * velocity[0] + cos * velocity[1]];
                positions.extend((1..=HORIZON).map(|t| {
                    let t = t as f64;
                    [start[0] + t * v[0], start[1] + t * v[1]]
                }));
            }
        }
        Ok(Forecast::with_equal_weights(window.len(), samples, positions)?)
    }
}

fn stream(seed: u64, window: &Window) -> ChaCha8Rng {
    // FNV-1a, so that the key does not depend on the standard library's hasher.
    let key = window
        .recording()
        .bytes()
        .fold(0xcbf2_9ce4_8422_2325_u64, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3));
    let mut random = ChaCha8Rng::seed_from_u64(seed ^ key);
    random.set_stream(window.start_frame().cast_unsigned());
    random
}

#[cfg(test)]
#[allow(clippy::float_cmp, reason = "sums and products of small integers are exact")]
mod tests {
    use approx::assert_relative_eq;
    use ddl_core::PedestrianId;

    use super::*;

    /// Steps of 1 m along x, but the last one is 2 m along y.
    fn turning() -> Window {
        let mut track: Vec<_> = (0..7).map(|t| [f64::from(t), 0.0]).collect();
        track.push([6.0, 2.0]);
        Window::new("corridor", 30, 10, vec![PedestrianId(1)], vec![track]).unwrap()
    }

    #[test]
    fn noise_turns_but_keeps_the_speed_and_the_seed_decides() {
        let noisy = ConstantVelocity::AngularNoise { seed: 3 };
        let at = |recording: &str, start: i64| {
            let track = turning().track(0).to_vec();
            Window::new(recording, start, 10, vec![PedestrianId(1)], vec![track]).unwrap()
        };
        let forecast_at = |recording, start| noisy.forecast(&at(recording, start)).unwrap();
        let forecast = forecast_at("corridor", 30);
        assert_eq!(forecast.hypotheses(), 20);
        assert_ne!(forecast, forecast_at("corridor", 40));
        assert_ne!(forecast, forecast_at("yard", 30));
        let mut headings = Vec::new();
        for (start, k) in (0..100).flat_map(|start| (0..20).map(move |k| (start, k))) {
            let end = forecast_at("corridor", start).hypothesis(0, k)[11];
            let (dx, dy) = (end[0] - 6.0, end[1] - 2.0);
            assert_relative_eq!(dx.hypot(dy), 24.0, epsilon = 1e-9);
            headings.push(dy.atan2(dx).to_degrees() - 90.0);
        }
        let rms = (headings.iter().map(|h| h * h).sum::<f64>() / 2000.0).sqrt();
        // The root mean square of 2,000 draws of N(0, 25^2) deviates by 0.4.
        assert!((rms - 25.0).abs() < 1.6, "{rms}");
        assert_eq!(forecast, noisy.forecast(&turning()).unwrap());
        assert_ne!(forecast, ConstantVelocity::AngularNoise { seed: 4 }.forecast(&turning()).unwrap());
    }
}
