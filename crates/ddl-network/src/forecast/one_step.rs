//! The step of one pedestrian, computed by `ddl-dynamics`.

use ddl_dynamics::{
    Attractor, CholeskyMetric, DynamicsError, Euler, MotionBounds, NaturalGradientFlow, StableEuler, StepTime,
    rollout_into,
};
use nalgebra::Vector2;

/// Entry `i` of a list that is repeated.
pub(super) fn around<T: Copy>(entries: &[T], i: usize) -> T {
    entries[i % entries.len()]
}

/// One step by `ddl-dynamics`. An invalid step gives NaN; the integration in `f64` by `ddl` reports the error.
pub(super) fn next(
    place: [f32; 2],
    goal: [f32; 2],
    [a, b, c]: [f32; 3],
    (sigma, time): (f32, StepTime<f32>),
    bounds: Option<&MotionBounds<f32>>,
) -> [f32; 2] {
    let step = || -> Result<[f32; 2], DynamicsError> {
        let attractor = Attractor::new(Vector2::from(goal))?;
        let metric = CholeskyMetric::planar(a, b, c, sigma)?;
        let start = Vector2::from(place);
        let mut path = [start; 2];
        match bounds {
            None => {
                let flow = NaturalGradientFlow::new(attractor, metric);
                rollout_into(&flow, &Euler, start, time.dt, &mut path)?;
            }
            Some(bounds) => {
                let metric = bounds.shape(&metric, &(attractor.goal() - start), time);
                let flow = NaturalGradientFlow::new(attractor, metric);
                rollout_into(&flow, &StableEuler, start, time.dt, &mut path)?;
            }
        }
        Ok(path[1].into())
    };
    step().unwrap_or([f32::NAN; 2])
}
