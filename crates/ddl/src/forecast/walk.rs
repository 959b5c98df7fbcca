//! The path of one hypothesis of one pedestrian. The network emits the factors of P, and `ddl-dynamics` integrates them
//! to positions in `f64`, with the integrator whose guarantee holds for the computed numbers. Positions from elsewhere
//! can be certified as well.

use ddl_core::{HORIZON, Position};
use ddl_dynamics::{
    Attractor, CholeskyMetric, DynamicsError, LyapunovCertificate, MetricSource, MotionBounds, NaturalGradientFlow,
    StableEuler, State, arriving_schedule, rollout_into,
};
use nalgebra::Vector2;
use std::cell::RefCell;

#[derive(Debug, Clone, Copy)]
pub(crate) struct GoalApproach {
    /// Last observed position, metres.
    pub(crate) start: Position,
    pub(crate) goal: Position,
    /// sigma of P = L L^T + sigma I, m/s.
    pub(crate) sigma: f64,
    pub(crate) time_step: f64,
    pub(crate) bounds: MotionBounds<f64>,
}

#[derive(Debug)]
pub(crate) struct CertifiedWalk {
    /// One for each step, without the start; metres.
    pub(crate) positions: [Position; HORIZON],
    pub(crate) certificate: LyapunovCertificate<f64>,
}

impl GoalApproach {
    /// Integrates the approach with `StableEuler` steps in `f64`, shaped by one factor (a, b, c) for each step.
    pub(crate) fn walk(&self, factors: &[[f64; 3]]) -> Result<CertifiedWalk, DynamicsError> {
        let attractor = Attractor::new(Vector2::from(self.goal))?;
        let schedule = arriving_schedule(self.metrics(factors)?, attractor, self.bounds, self.time_step)?;
        // The rollout asks once for each step, at the positions that the certificate needs too.
        let metrics = RefCell::new(Vec::with_capacity(HORIZON));
        let source = |state: &State<f64, 2>| {
            let metric = schedule.metric(state)?;
            metrics.borrow_mut().push(metric);
            Ok(metric)
        };
        let flow = NaturalGradientFlow::new(attractor, source);
        let mut path = [Vector2::zeros(); HORIZON + 1];
        let start = Vector2::from(self.start);
        rollout_into(&flow, &StableEuler, start, self.time_step, &mut path)?;
        let certificate = LyapunovCertificate::new(&path, &metrics.take(), &attractor, self.time_step)?;
        Ok(CertifiedWalk {
            certificate: certificate.within(&path, &attractor, &self.bounds)?,
            positions: std::array::from_fn(|t| path[t + 1].into()),
        })
    }

    /// The evidence for positions from elsewhere, with one factor (a, b, c) for each step.
    pub(crate) fn certify(
        &self,
        positions: &[Position],
        factors: &[[f64; 3]],
    ) -> Result<LyapunovCertificate<f64>, DynamicsError> {
        let attractor = Attractor::new(Vector2::from(self.goal))?;
        let path: Vec<Vector2<f64>> =
            std::iter::once(&self.start).chain(positions).map(|&position| position.into()).collect();
        let metrics = self.metrics(factors)?;
        LyapunovCertificate::new(&path, &metrics, &attractor, self.time_step)
    }

    /// The metrics of all steps. An error names the step of an invalid factor.
    fn metrics(&self, factors: &[[f64; 3]]) -> Result<Vec<CholeskyMetric<f64, 2>>, DynamicsError> {
        let mut metrics = Vec::with_capacity(factors.len());
        for (step, &[a, b, c]) in factors.iter().enumerate() {
            let metric = CholeskyMetric::planar(a, b, c, self.sigma);
            metrics.push(metric.map_err(|cause| DynamicsError::Step { step, cause: Box::new(cause) })?);
        }
        Ok(metrics)
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a test may panic")]

    use super::*;

    fn approach() -> GoalApproach {
        GoalApproach {
            start: [1.0, -2.0],
            goal: [2.8, -4.4],
            sigma: 1e-8,
            time_step: 0.5,
            bounds: MotionBounds::new(2.15, Vector2::new(0.3, -0.4), 1.0).unwrap(),
        }
    }

    /// 3 m in 12 steps of 0.5 s at the velocity that arrives, with L = I, which causes no departure: a straight line.
    #[test]
    fn straight_on_at_half_a_metre_a_second() {
        let approach = approach();
        let walk = approach.walk(&[[1.0, 0.0, 1.0]; HORIZON]).unwrap();
        for (t, position) in (1..).zip(walk.positions) {
            let [x, y] = [1.0 + 0.15 * f64::from(t), -2.0 - 0.2 * f64::from(t)];
            assert!((position[0] - x).abs() < 1e-7 && (position[1] - y).abs() < 1e-7);
        }
        assert_eq!(walk.certificate.verify(), Ok(()));
        let motion = walk.certificate.motion().unwrap();
        assert!((motion.speed.largest - 0.5).abs() < 1e-6 && (motion.speed.bound - 2.15).abs() < 1e-6);
        assert!(motion.distance_left.largest < 1e-9);
        let certified = approach.certify(&walk.positions, &[[1.0, 0.0, 1.0]; HORIZON]).unwrap();
        assert_eq!(certified.verify(), Ok(()));
        assert_eq!(certified.motion(), None);
    }

    #[test]
    fn an_invalid_factor_is_named_with_its_step() {
        let mut factors = [[1.0, 0.0, 1.0]; HORIZON];
        factors[7][1] = f64::NAN;
        for error in
            [approach().walk(&factors).unwrap_err(), approach().certify(&[[0.0, 0.0]; HORIZON], &factors).unwrap_err()]
        {
            assert!(matches!(error, DynamicsError::Step { step: 7, .. }), "{error}");
            assert!(error.to_string().contains("(1, 0)"), "{error}");
        }
    }
}
