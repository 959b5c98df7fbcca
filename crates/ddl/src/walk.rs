//! One hypothesis of one walker: walked by the reference implementation, or certified as it was walked.
//!
//! The network emits the factors of P; `ddl-dynamics` turns them into positions in `f64`, by the
//! integrator whose guarantee holds for the computed numbers.

use ddl_data::{HORIZON, Position};
use ddl_dynamics::{
    Attractor, CholeskyMetric, DynamicsError, LyapunovCertificate, MetricSchedule,
    NaturalGradientFlow, StableEuler, rollout_into,
};
use nalgebra::Vector2;

/// What a walk needs besides its shape.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Course {
    /// Last observed position, metres.
    pub(crate) start: Position,
    /// Metres.
    pub(crate) goal: Position,
    /// sigma of P = L L^T + sigma I, m/s.
    pub(crate) sigma: f64,
    /// Seconds a step.
    pub(crate) time_step: f64,
}

/// A walk with the evidence that it goes to its goal.
#[derive(Debug)]
pub(crate) struct Walk {
    /// One a step, the start left out; metres.
    pub(crate) positions: [Position; HORIZON],
    pub(crate) certificate: LyapunovCertificate<f64>,
}

impl Course {
    /// Walks the course with `StableEuler` steps in `f64`, shaped by one factor (a, b, c) a step.
    pub(crate) fn walk(&self, factors: &[[f64; 3]]) -> Result<Walk, DynamicsError> {
        let attractor = Attractor::new(Vector2::from(self.goal))?;
        let metrics = MetricSchedule::new(self.metrics(factors)?)?;
        let flow = NaturalGradientFlow::new(attractor, metrics);
        let mut path = [Vector2::zeros(); HORIZON + 1];
        let start = Vector2::from(self.start);
        rollout_into(&flow, &StableEuler, start, self.time_step, &mut path)?;
        let metrics = flow.source().metrics();
        Ok(Walk {
            certificate: LyapunovCertificate::new(&path, metrics, &attractor, self.time_step)?,
            positions: std::array::from_fn(|t| path[t + 1].into()),
        })
    }

    /// The evidence for positions that were walked elsewhere, with one factor (a, b, c) a step.
    pub(crate) fn certify(
        &self,
        positions: &[Position],
        factors: &[[f64; 3]],
    ) -> Result<LyapunovCertificate<f64>, DynamicsError> {
        let attractor = Attractor::new(Vector2::from(self.goal))?;
        let path: Vec<Vector2<f64>> = std::iter::once(&self.start)
            .chain(positions)
            .map(|&position| position.into())
            .collect();
        let metrics = self.metrics(factors)?;
        LyapunovCertificate::new(&path, &metrics, &attractor, self.time_step)
    }

    /// The metrics of all steps; one that is none is named with its step.
    fn metrics(&self, factors: &[[f64; 3]]) -> Result<Vec<CholeskyMetric<f64, 2>>, DynamicsError> {
        let metric = |(step, &[a, b, c]): (usize, &[f64; 3])| {
            CholeskyMetric::planar(a, b, c, self.sigma).map_err(|cause| DynamicsError::Step {
                step,
                cause: Box::new(cause),
            })
        };
        factors.iter().enumerate().map(metric).collect()
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a test may panic")]

    use super::*;

    const COURSE: Course = Course {
        start: [0.0, 0.0],
        goal: [3.0, 0.0],
        sigma: 1e-8,
        time_step: 0.5,
    };

    /// L = I, so P u = u (1 + sigma): 1 m/s straight on, at the goal after six steps of 0.5 m.
    #[test]
    fn straight_on_at_one_metre_a_second() {
        let walk = COURSE.walk(&[[1.0, 0.0, 1.0]; HORIZON]).unwrap();
        for (t, position) in (1..).zip(walk.positions) {
            let x = (0.5 * f64::from(t)).min(3.0);
            assert!((position[0] - x).abs() < 1e-7 && position[1].abs() < 1e-12);
        }
        let bits = |p: Position| p.map(f64::to_bits);
        assert_eq!(bits(walk.positions[HORIZON - 1]), bits(COURSE.goal));
        assert_eq!(walk.certificate.holds(), Ok(()));
        let certified = COURSE
            .certify(&walk.positions, &[[1.0, 0.0, 1.0]; HORIZON])
            .unwrap();
        assert_eq!(certified, walk.certificate);
    }

    #[test]
    fn a_walk_past_the_goal_is_certified_as_it_is() {
        let overshoots: Vec<Position> = (1..=12).map(|t| [2.0 * f64::from(t), 0.0]).collect();
        let certificate = COURSE
            .certify(&overshoots, &[[2.0, 0.0, 2.0]; HORIZON])
            .unwrap();
        // 3 m, 1 m, 1 m behind it: the second step is the first that comes no nearer
        let violation = certificate.holds().unwrap_err();
        assert!(violation.to_string().starts_with("step 1 "), "{violation}");
    }

    #[test]
    fn a_factor_that_is_no_number_is_named_with_its_step() {
        let mut factors = [[1.0, 0.0, 1.0]; HORIZON];
        factors[7][1] = f64::NAN;
        for error in [
            COURSE.walk(&factors).unwrap_err(),
            COURSE
                .certify(&[[0.0, 0.0]; HORIZON], &factors)
                .unwrap_err(),
        ] {
            assert!(
                matches!(error, DynamicsError::Step { step: 7, .. }),
                "{error}"
            );
            assert!(error.to_string().contains("(1, 0)"), "{error}");
        }
    }
}
