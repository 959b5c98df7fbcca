//! Adam (Kingma and Ba 2015) with accessible state, so that it can be saved and restored.

use crate::model::Parameters;
use crate::training::gate::FiniteGate;
use tch::Tensor;

const BETA_1: f64 = 0.9;
const BETA_2: f64 = 0.999;
const EPSILON: f64 = 1e-8;

/// Adam over all learned parameters as one vector.
#[derive(Debug)]
pub(crate) struct Adam {
    steps: u64,
    pub(crate) first_moment: Tensor,
    pub(crate) second_moment: Tensor,
}

impl Adam {
    /// Initial state for a network's parameters.
    pub(crate) fn new(parameters: &Parameters) -> Self {
        Self {
            steps: 0,
            first_moment: parameters.flat().zeros_like(),
            second_moment: parameters.flat().zeros_like(),
        }
    }

    pub(crate) fn set_steps(&mut self, steps: u64) {
        self.steps = steps;
    }

    /// One step against `gradient`, whose norm is `norm`, clipped to norm `clip`. If the gate is shut, the parameters
    /// and moments do not change for any gradient, but the step is counted. Shapes: `gradient` has
    /// [`Parameters::count`] entries; `norm` is a scalar.
    ///
    /// # Numerics
    /// m / (1 - b1^n) / (sqrt(v / (1 - b2^n)) + e) is computed as c m / (sqrt(v) + e'), with both corrections in the
    /// scalars: nine passes over the numbers in total, without reading from the device.
    pub(crate) fn step(
        &mut self,
        parameters: &Parameters,
        gradient: &Tensor,
        norm: &Tensor,
        clip: f64,
        learning_rate: f64,
        gate: &FiniteGate,
    ) {
        let _guard = tch::no_grad_guard();
        let mut gradient = gradient * (clip / (norm + 1e-6)).clamp_max(1.0);
        // NaN times 0 is NaN, so use a mask.
        let _ = gradient.masked_fill_(&gate.shut(), 0.0);
        self.steps += 1;
        let power = i32::try_from(self.steps).unwrap_or(i32::MAX);
        let correction_1 = 1.0 - BETA_1.powi(power);
        let correction_2 = (1.0 - BETA_2.powi(power)).sqrt();
        let open = gate.open();
        let _ = self.first_moment.lerp_tensor_(&gradient, &(open * (1.0 - BETA_1)));
        let _ = self
            .second_moment
            .lerp_tensor_(&gradient.square(), &(open * (1.0 - BETA_2)));
        let mut scale = self.second_moment.sqrt();
        scale += EPSILON * correction_2;
        let rate = open * (-learning_rate * correction_2 / correction_1);
        let mut flat = parameters.flat().shallow_clone();
        let _ = flat.addcdiv_(&(&self.first_moment * rate), &scale);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ddl_network::seed::{Stage, stream};
    use ddl_network::weights::Layout;
    use tch::{Device, Kind};

    fn parameters() -> Parameters {
        let rng = stream(1, Stage::Weights, 0);
        let mut layout = Layout::default();
        layout.uniform("weight".to_owned(), &[4, 3], 1.0);
        let initial = layout.initial(rng);
        Parameters::new(layout, &initial, Device::Cpu, Kind::Double)
    }

    fn largest(difference: &Tensor) -> f64 {
        difference.abs().max().double_value(&[])
    }

    #[test]
    fn it_agrees_with_the_paper() {
        let parameters = parameters();
        let mut adam = Adam::new(&parameters);
        let gate = FiniteGate::new(Device::Cpu, Kind::Double);
        let mut expected: Vec<f64> = Vec::try_from(parameters.flat()).unwrap();
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
            adam.step(&parameters, &gradient, &gradient.norm(), 2.0, 0.01, &gate);
            let difference = parameters.flat() - Tensor::from_slice(&expected);
            assert!(largest(&difference) < 1e-13, "step {step}");
        }
    }

    #[test]
    fn a_shut_gate_leaves_everything_as_it_was() {
        let parameters = parameters();
        let mut adam = Adam::new(&parameters);
        let mut gate = FiniteGate::new(Device::Cpu, Kind::Double);
        let gradient = Tensor::linspace(-1.0, 2.0, 12, (Kind::Double, Device::Cpu));
        adam.step(&parameters, &gradient, &gradient.norm(), 1.0, 0.01, &gate);
        let state = |adam: &Adam| [parameters.flat(), &adam.first_moment, &adam.second_moment].map(Tensor::copy);
        let before = state(&adam);
        gate.watch(&Tensor::from_slice(&[0.0, 1e308]));
        assert_eq!(gate.shut().int64_value(&[]), 0);
        gate.watch(&Tensor::from_slice(&[1.0, f64::INFINITY]));
        gate.watch(&Tensor::from_slice(&[1.0]));
        for bad in [f64::NAN, f64::INFINITY, 1.0] {
            let gradient = &gradient * bad;
            adam.step(&parameters, &gradient, &gradient.norm(), 1.0, 0.01, &gate);
            assert_eq!(state(&adam), before, "{bad}");
        }
        gate.reopen();
        adam.step(&parameters, &gradient, &gradient.norm(), 1.0, 0.01, &gate);
        assert_ne!(state(&adam), before);
    }
}
