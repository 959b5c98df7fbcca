//! The output layer and its noise.

use crate::model::goal_frame::SMALLEST_PIVOT;
use crate::model::tensor_backend::TensorBackend;
use ddl_network::weights::Linear;
use tch::Tensor;

/// The noise of the output layer.
#[derive(Debug)]
pub(crate) enum NoiseInput {
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

/// The output layer of a pass, with its noise prepared once for all steps.
#[derive(Debug)]
pub(super) struct Emission<B: TensorBackend> {
    layer: Linear,
    /// The inputs of the layer after the token, `[B, P, noise]`.
    noise: B::Tokens,
    /// For the expectation of the metric.
    covariance: Option<NoiseCovariance>,
}

impl<B: TensorBackend> Emission<B> {
    /// Shapes: `noise_weight` `[outputs, noise]`, the columns of the layer's weight for the noise; `entries` and
    /// `pedestrians` are those of the tokens.
    pub(super) fn new(
        backend: &B,
        layer: Linear,
        noise_weight: &Tensor,
        noise: &NoiseInput,
        [entries, pedestrians]: [i64; 2],
        dynamics: bool,
    ) -> Self {
        let shape = [entries, pedestrians, noise_weight.size()[1]];
        let (rows, covariance) = match noise {
            NoiseInput::Draws(draws) => (draws.unsqueeze(1).expand(shape, false), None),
            NoiseInput::Expected => (
                Tensor::zeros(shape, (noise_weight.kind(), noise_weight.device())),
                dynamics.then(|| NoiseCovariance::of(noise_weight)),
            ),
        };
        Self { layer, noise: backend.given(&rows), covariance }
    }

    /// The outputs for each pedestrian, (a, b, c) or (x, y), after all batch entries of all tokens. All pedestrians
    /// share the noise.
    pub(super) fn factors(&self, backend: &B, tokens: &[B::Tokens]) -> Tensor {
        let outputs = tokens.iter().map(|token| backend.linear(self.layer, &backend.concatenate(token, &self.noise)));
        let outputs = backend.outputs(&outputs.collect::<Vec<_>>());
        match &self.covariance {
            Some(covariance) => covariance.expected_factor(&outputs),
            None => outputs,
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
        Self { c11: c(0, 0), c12: c(0, 1), c22: c(1, 1) + c(2, 2) }
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
