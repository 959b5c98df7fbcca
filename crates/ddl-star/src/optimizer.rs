//! Adam (Kingma and Ba 2015) with its state in our hands, so that it can be saved and restored.

use crate::parameters::Parameters;
use tch::Tensor;

const BETA_1: f64 = 0.9;
const BETA_2: f64 = 0.999;
const EPSILON: f64 = 1e-8;

/// Adam over all learned numbers as one vector.
#[derive(Debug)]
pub(crate) struct Adam {
    steps: u64,
    pub(crate) first_moment: Tensor,
    pub(crate) second_moment: Tensor,
}

impl Adam {
    /// Fresh state for a network's parameters.
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

    /// One step against `gradient`, whose norm is `norm`, clipped to norm `clip`.
    ///
    /// # Shapes
    /// `gradient`: as many numbers as [`Parameters::count`]; `norm`: scalar.
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
        let correction_2 = 1.0 - BETA_2.powi(power);
        let _ = self.first_moment.lerp_(&gradient, 1.0 - BETA_1);
        let _ = self.second_moment.g_mul_scalar_(BETA_2);
        self.second_moment += gradient.square() * (1.0 - BETA_2);
        let scale = (&self.second_moment / correction_2).sqrt() + EPSILON;
        let mut flat = parameters.flat().shallow_clone();
        flat -= (&self.first_moment / scale) * (learning_rate / correction_1);
    }
}
