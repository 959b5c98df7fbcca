//! The step of one pedestrian, computed by `ddl-dynamics`.

use ddl_dynamics::{
    Attractor, CholeskyMetric, DynamicsError, Euler, Integrator as _, MotionBounds, NaturalGradientFlow, StableEuler,
    State, StepTime,
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
        let state = State::new(Vector2::from(place), 0, 0.0);
        let next = match bounds {
            None => Euler.step(&NaturalGradientFlow::new(attractor, metric), &state, time.dt),
            Some(bounds) => {
                let metric = bounds.shape(&metric, &(attractor.goal() - state.position), time);
                StableEuler.step(&NaturalGradientFlow::new(attractor, metric), &state, time.dt)
            }
        };
        Ok(next?.into())
    };
    step().unwrap_or([f32::NAN; 2])
}
