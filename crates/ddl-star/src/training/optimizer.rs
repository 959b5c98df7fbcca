//! Adam (Kingma and Ba 2015) with accessible state, so that it can be saved and restored.

use crate::model::Parameters;
use tch::Tensor;

const BETA_1: f64 = 0.9;
const BETA_2: f64 = 0.999;
const EPSILON: f64 = 1e-8;

/// Adam over all learned parameters as one vector.
#[derive(Debug)]
pub(crate) struct Adam {
    pub(crate) steps: u64,
    pub(crate) first_moment: Tensor,
    pub(crate) second_moment: Tensor,
}

impl Adam {
    /// Initial state for a network's parameters.
    pub(crate) fn new(parameters: &Parameters) -> Self {
        Self { steps: 0, first_moment: parameters.flat.zeros_like(), second_moment: parameters.flat.zeros_like() }
    }

    /// One step against `gradient`, whose norm is `norm`, clipped to norm `clip`. Shapes: `gradient` has
    /// [`Layout::count`](ddl_network::weights::Layout::count) entries; `norm` is a scalar.
    ///
    /// # Numerics
    /// m / (1 - b1^n) / (sqrt(v / (1 - b2^n)) + e) is computed as c m / (sqrt(v) + e'), with both corrections in the
    /// scalars.
    pub(crate) fn step(
        &mut self,
        parameters: &Parameters,
        gradient: &Tensor,
        norm: &Tensor,
        clip: f64,
        learning_rate: f64,
    ) {
        let _guard = tch::no_grad_guard();
        let gradient = gradient * (clip / (norm + 1e-6)).clamp_max(1.0);
        self.steps += 1;
        let power = i32::try_from(self.steps).unwrap_or(i32::MAX);
        let correction_1 = 1.0 - BETA_1.powi(power);
        let correction_2 = (1.0 - BETA_2.powi(power)).sqrt();
        let _ = self.first_moment.lerp_(&gradient, 1.0 - BETA_1);
        let _ = self.second_moment.lerp_(&gradient.square(), 1.0 - BETA_2);
        let mut scale = self.second_moment.sqrt();
        scale += EPSILON * correction_2;
        let rate = -learning_rate * correction_2 / correction_1;
        let mut flat = parameters.flat.shallow_clone();
        let _ = flat.addcdiv_(&(&self.first_moment * rate), &scale);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ddl_network::seed::{Stage, stream};
    use ddl_network::weights::Layout;
    use tch::{Device, Kind};

    #[test]
    fn it_agrees_with_the_paper() {
        let mut layout = Layout::default();
        layout.linear("layer", 3, 3);
        let initial = layout.initial(stream(1, Stage::Weights, 0));
        let parameters = Parameters::new(layout, &initial, Device::Cpu, Kind::Double);
        let mut adam = Adam::new(&parameters);
        let mut expected: Vec<f64> = Vec::try_from(&parameters.flat).unwrap();
        let (mut m, mut v) = ([0.0; 12], [0.0; 12]);
        for step in 1..=5_i32 {
            let gradient: Vec<f64> = (0..12).map(|i| f64::from(i - 5) * 0.3 * f64::from(step)).collect();
            let norm = gradient.iter().map(|g| g * g).sum::<f64>().sqrt();
            let factor = (2.0 / (norm + 1e-6)).min(1.0);
            for (i, g) in gradient.iter().map(|g| g * factor).enumerate() {
                m[i] = 0.9 * m[i] + 0.1 * g;
                v[i] = 0.999 * v[i] + 0.001 * g * g;
                let m_hat: f64 = m[i] / (1.0 - 0.9_f64.powi(step));
                let v_hat: f64 = v[i] / (1.0 - 0.999_f64.powi(step));
                expected[i] -= 0.01 * m_hat / (v_hat.sqrt() + 1e-8);
            }
            let gradient = Tensor::from_slice(&gradient);
            adam.step(&parameters, &gradient, &gradient.norm(), 2.0, 0.01);
            let difference = &parameters.flat - Tensor::from_slice(&expected);
            assert!(difference.abs().max().double_value(&[]) < 1e-13, "step {step}");
        }
    }
}
