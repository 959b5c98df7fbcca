//! Forecasters without a model, as references for every result.

mod constant_acceleration;
mod constant_velocity;
mod social_force;
mod straight_line;

use ddl_core::{Forecaster, Window};

pub use constant_acceleration::ConstantAcceleration;
pub use constant_velocity::ConstantVelocity;
pub use social_force::SocialForce;
pub use straight_line::{GoalSource, StraightLine, TrueEndpoint};

use crate::conditions::{Conditions, ResultRow};
use crate::error::EvaluationError;

/// Seed of the baseline with angular noise, so that its rows are reproducible.
const NOISE_SEED: u64 = 1;

/// Measures the baselines that a protocol admits on the windows of one fold.
///
/// These are constant velocity, bounded constant acceleration, the social force model, and the straight line to the
/// TRUE end where the future is visible. The fields of `conditions` on the forecaster and its training are replaced.
///
/// # Errors
/// The windows cannot be scored.
pub fn measure(conditions: &Conditions, windows: &[Window]) -> Result<Vec<ResultRow>, EvaluationError> {
    measure_among(conditions, windows, windows)
}

pub(crate) fn measure_among(
    conditions: &Conditions,
    windows: &[Window],
    full_windows: &[Window],
) -> Result<Vec<ResultRow>, EvaluationError> {
    let row = |forecaster: &dyn Forecaster, seed| {
        let conditions = Conditions {
            forecaster: forecaster.name(),
            variant: None,
            seed,
            epochs: None,
            selection: None,
            recipe: None,
            device: "cpu".to_owned(),
            training_subset: None,
            ..conditions.clone()
        };
        ResultRow::measure_among(conditions, forecaster, windows, full_windows)
    };
    let mut rows = vec![row(&ConstantVelocity::LastStep, None)?, row(&ConstantVelocity::MeanObserved, None)?];
    if conditions.protocol.hypotheses() > 1 {
        let noise = ConstantVelocity::AngularNoise { seed: NOISE_SEED };
        rows.push(row(&noise, Some(NOISE_SEED))?);
    }
    rows.push(row(&ConstantAcceleration, None)?);
    rows.push(row(&SocialForce, None)?);
    if conditions.protocol.gives_future() {
        rows.push(row(&StraightLine(TrueEndpoint), None)?);
    }
    Ok(rows)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixture::walking;
    use crate::protocol::Protocol;
    use ddl_data::{Convention, WindowRule};

    /// Constant velocity is exact for a pedestrian that keeps it. The oracle is measured only under protocols that show
    /// the future, the noise only under those that score several hypotheses.
    #[test]
    fn each_protocol_has_its_baselines() {
        let windows = [walking(&[([0.0, 0.0], [0.4, 0.0])], 20)];
        let kinds = |protocol: Protocol| {
            let (convention, rule) = (Convention::Star, WindowRule::Complete);
            let conditions = Conditions::new(convention, rule, protocol, "yard", "mine");
            let rows = measure(&conditions, &windows).unwrap();
            assert_eq!(rows[0].conditions.forecaster, "constant velocity (last step)");
            assert!(rows[0].scores.min_fde < 1e-9);
            (rows.len(), rows.iter().filter_map(|row| row.conditions.seed).collect())
        };
        assert_eq!(kinds(Protocol::Published), (6, vec![1]));
        assert_eq!(kinds(Protocol::Fair), (5, vec![1]));
        assert_eq!(kinds(Protocol::Single), (4, vec![]));
    }
}
