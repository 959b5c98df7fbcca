//! The output layer and its noise.

use ddl_network::StarConfig;
use tch::Tensor;

/// The noise of the output layer.
#[derive(Debug)]
pub enum NoiseInput {
    /// One vector for each hypothesis (or one for all), `[1 or H, noise]`.
    Draws(Tensor),
    /// The expectation over N(0, 1) noise.
    Expected,
}

impl NoiseInput {
    pub(crate) fn count(&self) -> i64 {
        match self {
            Self::Draws(draws) => draws.size()[0],
            Self::Expected => 1,
        }
    }
}

/// The output layer with its noise, prepared once for all steps.
#[derive(Debug)]
pub(crate) struct Emission<'a> {
    weight: &'a Tensor,
    bias: &'a Tensor,
    noise: Prepared<'a>,
}

#[derive(Debug)]
enum Prepared<'a> {
    Draws(&'a Tensor),
    Expected {
        /// The columns of the weight for the token.
        weight: Tensor,
        spread: Option<NoiseCovariance>,
    },
}

impl<'a> Emission<'a> {
    /// Shapes: `weight` `[outputs, width + noise]`, `bias` `[outputs]`.
    pub(crate) fn new([weight, bias]: [&'a Tensor; 2], noise: &'a NoiseInput, config: &StarConfig) -> Self {
        let (width, count) = (config.output_inputs(), config.noise_width);
        let noise = match noise {
            NoiseInput::Draws(draws) => Prepared::Draws(draws),
            NoiseInput::Expected => {
                let of_noise = weight.narrow(1, width, count);
                let dynamics = config.variant.dynamics();
                Prepared::Expected {
                    weight: weight.narrow(1, 0, width),
                    spread: dynamics.then(|| NoiseCovariance::of(&of_noise)),
                }
            }
        };
        Self { weight, bias, noise }
    }

    /// The output for each pedestrian: (a, b, c), or (x, y). All pedestrians share the noise.
    /// Shapes: `tokens` `[B, P, width]` -> `[B, P, outputs]`.
    pub(crate) fn of(&self, tokens: &Tensor) -> Tensor {
        let (batch, pedestrians) = (tokens.size()[0], tokens.size()[1]);
        let bias = Some(self.bias);
        match &self.noise {
            Prepared::Draws(noise) => {
                let noise = noise.unsqueeze(1).expand([batch, pedestrians, -1], false);
                Tensor::cat(&[tokens, &noise], -1).linear(self.weight, bias)
            }
            Prepared::Expected { weight, spread } => {
                let mean = tokens.linear(weight, bias);
                match spread {
                    Some(spread) => spread.expected_factor(&mean),
                    None => mean,
                }
            }
        }
    }
}

/// The effect of noise on the metric: entries of C = W W^T, the covariance of W n for noise n ~ N(0, I).
#[derive(Debug)]
struct NoiseCovariance {
    c11: Tensor,
    c12: Tensor,
    c22: Tensor,
}

impl NoiseCovariance {
    /// Shapes: `weight` `[3, noise]`, the columns of the output layer for the noise.
    fn of(weight: &Tensor) -> Self {
        let covariance = weight.matmul(&weight.transpose(0, 1));
        let c = |i: i64, j: i64| covariance.get(i).get(j);
        Self {
            c11: c(0, 0),
            c12: c(0, 1),
            c22: c(1, 1) + c(2, 2),
        }
    }

    /// The Cholesky factor of E[L L^T] when noise adds W n to (a, b, c).
    ///
    /// The output is linear in the noise, so E[L L^T] = L0 L0^T + E[D D^T] with D built from W n. L0 L0^T alone would
    /// give speeds that are too low.
    /// Shapes: `mean` `[.., 3]` -> `[.., 3]`.
    fn expected_factor(&self, mean: &Tensor) -> Tensor {
        let l = |i: i64| mean.narrow(-1, i, 1);
        let (a, b, d) = (l(0), l(1), l(2));
        let p11 = a.square() + &self.c11;
        let p12 = &a * &b + &self.c12;
        let p22 = b.square() + d.square() + &self.c22;
        let first = p11.clamp_min(SMALLEST_PIVOT).sqrt();
        let below = p12 / &first;
        let second = (p22 - below.square()).clamp_min(SMALLEST_PIVOT).sqrt();
        Tensor::cat(&[first, below, second], -1)
    }
}

/// Lower bound of the pivots of the expected metric, in m/s.
const SMALLEST_PIVOT: f64 = 1e-12;
